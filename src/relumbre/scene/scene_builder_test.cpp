#include "relumbre/scene/scene_builder.h"

#include <array>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

TEST(Placement, TurnsCounterClockwiseSeenFromAbove) {
  const Vec3f p = turned({5, 0, 0}, 90).point({1, 2, 0});
  EXPECT_NEAR(p.x, 5, 1e-6);
  EXPECT_NEAR(p.y, 2, 1e-6);
  EXPECT_NEAR(p.z, -1, 1e-6);
}

TEST(Placement, StaysRightHandedAlongAnyAxis) {
  for (const Vec3f& axis :
       {Vec3f(0, 1, 0), Vec3f(0, -1, 0), Vec3f(0, 0, -1), Vec3f(0.6F, 0.8F, 0)}) {
    const Placement p = along({}, axis);
    EXPECT_EQ(p.y, axis);
    EXPECT_NEAR(dot(cross(p.x, p.y), p.z), 1, 1e-6);
  }
}

TEST(Placement, ComposesLikeItsPoints) {
  const Placement a = turned({1, 2, 3}, 30), b = along({-1, 0, 2}, {0.6F, 0, 0.8F});
  const Vec3f p{0.3F, -0.7F, 1.1F};
  EXPECT_NEAR(length((a * b).point(p) - a.point(b.point(p))), 0, 1e-6);
}

TEST(SceneBuilder, OmitsTrianglesWithoutArea) {
  SceneBuilder builder;
  builder.add_matt("grey", Rgb(0.5F));
  builder.begin_object("sliver");
  builder.triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  builder.quad({0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Scene scene = std::move(builder).finish();
  EXPECT_EQ(scene.mesh.triangles.size(), 1U);
}

TEST(SceneBuilder, ScopedPlacementsNestAndEnd) {
  SceneBuilder builder;
  builder.place({{1, 0, 0}});
  {
    const ScopedPlacement inner(builder, {{0, 2, 0}});
    EXPECT_EQ(builder.placement().origin, Vec3f(1, 2, 0));
  }
  EXPECT_EQ(builder.placement().origin, Vec3f(1, 0, 0));
}

TEST(SceneBuilder, GivesOneLightToEveryObjectThatGlows) {
  SceneBuilder builder;
  const auto dark = builder.add_matt("dark", Rgb(0.1F));
  const auto glow = builder.add_glowing("glow", Rgb(3));
  for (const auto& [name, material] : {std::pair{"wall", dark}, {"left", glow}, {"right", glow}}) {
    builder.begin_object(name);
    builder.use(material);
    builder.quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  }
  const Scene scene = std::move(builder).finish();
  ASSERT_EQ(scene.lights.size(), 2U);
  EXPECT_EQ(scene.lights[0].name, "left");
  EXPECT_EQ(scene.lights[1].object, 2U);
  EXPECT_EQ(scene.lights[1].type, LightType::kEmitter);
  EXPECT_EQ(scene.lights[1].power(), Rgb(1));
}

}  // namespace
}  // namespace relumbre
