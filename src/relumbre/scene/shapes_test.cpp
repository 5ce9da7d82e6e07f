#include "relumbre/scene/shapes.h"

#include <array>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "relumbre/scene/mesh_checks.h"

namespace relumbre {
namespace {

template <class Add>
Scene built(Add&& add) {
  SceneBuilder builder;
  builder.use(builder.add_matt("grey", Rgb(0.5F)));
  builder.begin_object("thing");
  add(builder);
  return std::move(builder).finish();
}

void expect_unit_normals_on_the_front(const Scene& scene) {
  ASSERT_EQ(scene.shading_normals.size(), scene.mesh.positions.size());
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t)
    for (const std::uint32_t v : scene.mesh.triangles[t]) {
      EXPECT_NEAR(length(scene.shading_normals[v]), 1, 1e-5);
      EXPECT_GT(dot(scene.shading_normals[v], normalized(scene.mesh.scaled_normal(t))), 0.5F);
    }
}

TEST(Shapes, BoxIsClosedAndHoldsItsVolume) {
  const Scene scene = built([](SceneBuilder& b) { add_box(b, {1, 2, 3}, {2, 4, 6}); });
  EXPECT_EQ(scene.mesh.triangles.size(), 12U);
  EXPECT_EQ(unmatched_edges(scene.mesh), 0U);
  EXPECT_NEAR(signed_volume(scene.mesh), 6, 1e-5);
  expect_unit_normals_on_the_front(scene);
}

TEST(Shapes, BoxLeavesOutTheFacesThatAreNotAskedFor) {
  const Scene scene = built([](SceneBuilder& b) {
    add_box(b, {0, 0, 0}, {1, 1, 1}, kTopFace | kLeftFace);
  });
  ASSERT_EQ(scene.mesh.triangles.size(), 4U);
  EXPECT_EQ(normalized(scene.mesh.scaled_normal(0)), Vec3f(-1, 0, 0));
  EXPECT_EQ(normalized(scene.mesh.scaled_normal(2)), Vec3f(0, 1, 0));
}

TEST(Shapes, RoundedBoxTendsToTheVolumeOfItsSmoothLimit) {
  constexpr double r = 0.25, pi = std::numbers::pi;
  // Box of 2 × 1 × 1.5: the inner box, slabs on its faces, quarter cylinders, a sphere.
  const double a = 2 - 2 * r, b = 1 - 2 * r, c = 1.5 - 2 * r;
  const double limit = a * b * c + 2 * r * (a * b + b * c + c * a) + pi * r * r * (a + b + c) +
                       4.0 / 3 * pi * r * r * r;
  const Scene scene = built([](SceneBuilder& s) {
    add_rounded_box(s, {0, 0, 0}, {2, 1, 1.5F}, 0.25F, 8);
  });
  EXPECT_EQ(scene.mesh.triangles.size(), 12U * 17 * 17);
  EXPECT_NEAR(signed_volume(scene.mesh), limit, 0.003);
  expect_unit_normals_on_the_front(scene);
}

TEST(Shapes, SphereIsClosedAndTendsToItsVolume) {
  const Scene scene = built([](SceneBuilder& b) { add_sphere(b, {3, -1, 2}, 0.5F, 96); });
  EXPECT_EQ(unmatched_edges(scene.mesh), 0U);
  EXPECT_NEAR(signed_volume(scene.mesh), std::numbers::pi / 6, 0.002);
  expect_unit_normals_on_the_front(scene);
}

TEST(Shapes, RevolvedRectangleIsACylinder) {
  const Scene scene = built([](SceneBuilder& b) {
    add_revolved(b, std::array<Vec2f, 4>{{{0, 1}, {2, 1}, {2, 4}, {0, 4}}}, 128);
  });
  EXPECT_EQ(unmatched_edges(scene.mesh), 0U);
  EXPECT_NEAR(signed_volume(scene.mesh), 12 * std::numbers::pi, 0.03);
  expect_unit_normals_on_the_front(scene);
}

TEST(Shapes, BarIsAClosedConeFrustumInAnyDirection) {
  for (const Vec3f& axis :
       {Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(1, 0, 0), Vec3f(0.6F, 0, -0.8F)}) {
    const Scene scene = built([&](SceneBuilder& b) {
      add_bar(b, {1, 1, 1}, Vec3f(1) + axis * 3, 1, 2, 128);
    });
    EXPECT_EQ(unmatched_edges(scene.mesh), 0U);
    EXPECT_NEAR(signed_volume(scene.mesh), 7 * std::numbers::pi, 0.03);
  }
}

TEST(Shapes, LegFacesOutwardAndEndsOnTwoLevels) {
  const Scene scene = built([](SceneBuilder& b) {
    add_leg(b, {1, 0, 0}, {1.5F, 2, 0.5F}, 0.1F, 0.2F);
  });
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t) {
    const Vec3f middle =
        (scene.mesh.corner(t, 0) + scene.mesh.corner(t, 1) + scene.mesh.corner(t, 2)) / 3;
    const Vec3f axis{1 + middle.y / 4, middle.y, middle.y / 4};
    EXPECT_GT(dot(scene.mesh.scaled_normal(t), middle - axis), 0);
  }
  for (const Vec3f& p : scene.mesh.positions) EXPECT_TRUE(p.y == 0 || p.y == 2);
}

TEST(Shapes, PanelWithHolesKeepsTheRestOfItsArea) {
  const Plane plane{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::array<Rect, 2> holes{{{1, 1, 2, 3}, {2.5F, 0, 3, 1}}};
  const Scene scene = built([&](SceneBuilder& b) {
    add_panel(b, plane, {0, 0, 4, 5}, holes, 0.5F);
  });
  EXPECT_NEAR(total_area(scene.mesh), 20 - 2 - 0.5, 1e-5);
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t)
    EXPECT_EQ(normalized(scene.mesh.scaled_normal(t)), Vec3f(0, 0, 1));
  for (const Vec3f& p : scene.mesh.positions) EXPECT_EQ(p.z, 0.5F);
}

TEST(Shapes, FrameWithItsBackHoldsItsVolume) {
  const Plane plane{{1, 1, 1}, {0, 0, 1}, {1, 0, 0}};
  const Scene scene = built([&](SceneBuilder& b) {
    add_frame(b, plane, {{0, 0, 3, 2}, {0.5F, 0.5F, 2, 1}, 0.25F, 0.75F, true, true});
  });
  EXPECT_NEAR(signed_volume(scene.mesh), (6 - 0.75) * 0.5, 1e-5);
}

TEST(Shapes, SlabIsABoxWithoutItsBack) {
  const Plane plane{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  const Scene scene = built([&](SceneBuilder& b) { add_slab(b, plane, {0, 0, 1, 1}, 0.0F, 0.5F); });
  EXPECT_EQ(scene.mesh.triangles.size(), 10U);
  // The missing back lies in the plane through the origin and adds nothing.
  EXPECT_NEAR(signed_volume(scene.mesh), 0.5, 1e-6);
}

}  // namespace
}  // namespace relumbre
