#include "relumbre/scene/teapot.h"

#include <gtest/gtest.h>

#include "relumbre/base/box.h"
#include "relumbre/scene/mesh_checks.h"

namespace relumbre {
namespace {

Scene teapot(int subdivisions) {
  SceneBuilder builder;
  builder.use(builder.add_matt("clay", Rgb(0.5F)));
  builder.begin_object("teapot");
  add_teapot(builder, 3.15F, subdivisions);
  return std::move(builder).finish();
}

class TeapotAt : public ::testing::TestWithParam<int> {};

TEST_P(TeapotAt, IsAUnionOfClosedSolids) {
  EXPECT_EQ(unmatched_edges(teapot(GetParam()).mesh), 0U);
}
INSTANTIATE_TEST_SUITE_P(Subdivisions, TeapotAt, ::testing::Values(2, 3, 7, 10, 16));

TEST(Teapot, HasTheTrianglesThatThePatchesGive) {
  constexpr std::size_t n = 10;
  // 32 patches, less one row of poles at the knob's top and at the bottom's middle; the slit
  // between lid and rim; four caps of two halves.
  EXPECT_EQ(teapot(n).mesh.triangles.size(),
            32 * 2 * n * n - 4 * n - 4 * n + 4 * 2 * n + 4 * 2 * n);
}

TEST(Teapot, HasNewellsExtent) {
  const Box box = bounds(teapot(16).mesh.positions);
  EXPECT_NEAR(box.lower.y, 0, 1e-6);
  EXPECT_NEAR(box.upper.y, 3.15, 1e-6);
  EXPECT_NEAR(box.lower.z, -2, 0.02);
  EXPECT_NEAR(box.upper.z, 2, 0.02);
  EXPECT_NEAR(box.lower.x, -3, 0.05);
  EXPECT_NEAR(box.upper.x, 3.43, 0.05);
}

TEST(Teapot, ShowsNoBackFaceToRaysFromOutside) {
  const Scene scene = teapot(6);
  constexpr int kRays = 1500;
  int hits = 0;
  for (int i = 0; i < kRays; ++i) {
    const Vec3d from = sphere_direction(i, kRays) * 9.0 + Vec3d(0, 1.5, 0);
    const Vec3d towards = sphere_direction((i * 607) % kRays, kRays) * 1.6 + Vec3d(0.2, 1.4, 0);
    const auto hit = brute_closest(scene.mesh, from, towards - from);
    if (!hit) continue;
    ++hits;
    EXPECT_FALSE(hit->back) << "ray " << i;
  }
  EXPECT_GT(hits, kRays / 2);
}

TEST(Teapot, ShadingNormalsAreUnitAndOnTheFront) {
  const Scene scene = teapot(10);
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t)
    for (const std::uint32_t v : scene.mesh.triangles[t]) {
      const Vec3f& n = scene.shading_normals[v];
      EXPECT_NEAR(length(n), 1, 1e-5);
      EXPECT_GT(dot(n, normalized(scene.mesh.scaled_normal(t))), 0.2F) << "triangle " << t;
    }
}

}  // namespace
}  // namespace relumbre
