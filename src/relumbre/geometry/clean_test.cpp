#include "relumbre/geometry/clean.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/test_shapes.h"

namespace relumbre {
namespace {

using testing::ElementsAre;
constexpr Vec3f kA{0, 0, 0}, kB{1, 0, 0}, kC{0, 1, 0}, kD{0, 0, 1};

TEST(Clean, GoodMeshIsUnchanged) {
  TriangleMesh mesh = shapes::soup(1009, 1);
  const TriangleMesh before = mesh;
  const CleanReport report = clean(mesh);
  EXPECT_EQ(report.dropped(), 0U);
  EXPECT_EQ(report.kept.size(), 1009U);
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.positions, before.positions);
}

TEST(Clean, CountsEveryKind) {
  TriangleMesh mesh;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  shapes::add_triangle(mesh, kA, kB, {nan, 0, 0});
  shapes::add_triangle(mesh, kA, kB, kC);
  shapes::add_triangle(mesh, kA, kB, {0, inf, 0});
  shapes::add_triangle(mesh, kA, kB, {2, 0, 0});
  shapes::add_triangle(mesh, kB, kC, kA);
  shapes::add_triangle(mesh, kA, kB, kD);
  shapes::add_triangle(mesh, kA, kB, {0, 3e38F, 0});
  for (std::uint32_t t = 0; t < 7; ++t) mesh.material[t] = mesh.object[t] = t;
  const CleanReport report = clean(mesh);
  EXPECT_EQ(report.non_finite, 3U);
  EXPECT_EQ(report.degenerate, 1U);
  EXPECT_EQ(report.duplicate, 1U);
  EXPECT_THAT(report.kept, ElementsAre(1, 5));
  EXPECT_THAT(mesh.material, ElementsAre(1, 5));
  EXPECT_THAT(mesh.object, ElementsAre(1, 5));
  EXPECT_EQ(mesh.two_sided.size(), 2U);
  EXPECT_EQ(mesh.corner(1, 2), kD);
  for (const Vec3f& p : mesh.positions) EXPECT_LE(max_component(p), 2);
}

TEST(Clean, TheBackOfAThinWallStays) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, kA, kB, kC);
  shapes::add_triangle(mesh, kA, kC, kB);
  shapes::add_triangle(mesh, kC, kB, kA);
  EXPECT_EQ(clean(mesh).duplicate, 1U);
  EXPECT_EQ(mesh.triangles.size(), 2U);
}

TEST(Clean, ATwoSidedTriangleStandsForBothOrientations) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, kA, kB, kC, false);
  shapes::add_triangle(mesh, kC, kB, kA, true);
  shapes::add_triangle(mesh, kA, kC, kB, false);
  shapes::add_triangle(mesh, kB, kC, kA, true);
  const CleanReport report = clean(mesh);
  EXPECT_EQ(report.duplicate, 3U);
  EXPECT_THAT(report.kept, ElementsAre(1));
}

TEST(Clean, ZeroHasNoSign) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, kA, kB, kC);
  shapes::add_triangle(mesh, {-0.0F, 0, -0.0F}, {1, -0.0F, 0}, kC);
  EXPECT_EQ(clean(mesh).duplicate, 1U);
}

TEST(Clean, SliversGoByTheirCoordinatesRounding) {
  for (const float scale : {1e-9F, 1.0F, 1e9F}) {
    TriangleMesh mesh;
    shapes::add_triangle(mesh, Vec3f{1, 1, 1} * scale, Vec3f{2, 1, 1} * scale,
                         Vec3f{1, 1 + 1e-7F, 1} * scale);
    shapes::add_triangle(mesh, Vec3f{1, 1, 1} * scale, Vec3f{2, 1, 1} * scale,
                         Vec3f{1, 1.00001F, 1} * scale);
    EXPECT_THAT(clean(mesh).kept, ElementsAre(1)) << scale;
  }
}

TEST(Clean, WhatIsLeftCanBeTessellated) {
  TriangleMesh mesh = shapes::soup(307, 3);
  RandomStream random(5);
  for (Vec3f& p : mesh.positions) {
    if (random.uniform() < 0.1F)
      p.y = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
    if (random.uniform() < 0.1F) p = mesh.positions[0];
  }
  const CleanReport report = clean(mesh);
  EXPECT_GT(report.dropped(), 0U);
  EXPECT_EQ(report.kept.size() + report.dropped(), 307U);
  EXPECT_EQ(tessellate(mesh, {3, 400}).elements(), 400U);
}

TEST(Clean, EverythingMayGo) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, kA, kA, kA);
  EXPECT_EQ(clean(mesh).degenerate, 1U);
  EXPECT_TRUE(mesh.triangles.empty());
  TriangleMesh none;
  EXPECT_EQ(clean(none).dropped(), 0U);
}

TEST(Clean, BadShapesAreNamed) {
  TriangleMesh wild = shapes::soup(3, 1);
  wild.triangles[1][0] = 99;
  EXPECT_THROW(clean(wild), ValueError);
  TriangleMesh uneven = shapes::soup(3, 1);
  uneven.material.pop_back();
  EXPECT_THROW(clean(uneven), ShapeError);
}

}  // namespace
}  // namespace relumbre
