#include "relumbre/scene/scene.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

/// 2 × 2 texels, grey: 0, 255 above 255, 0.
Texture checker() { return {"checker", 2, 2, {0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0}}; }

TEST(Texture, TexelCentresAreTheTexels) {
  EXPECT_EQ(checker().sample({0.25F, 0.25F}), Rgb(0.0F));
  EXPECT_EQ(checker().sample({0.75F, 0.25F}), Rgb(1.0F));
  EXPECT_EQ(checker().sample({0.25F, 0.75F}), Rgb(1.0F));
}

TEST(Texture, BlendsLinearValuesAndWrapsAround) {
  for (const Vec2f uv : {Vec2f{0.5F, 0.5F}, Vec2f{0, 0}, Vec2f{0, 0.5F}, Vec2f{-3, 7}}) {
    EXPECT_NEAR(checker().sample(uv).x, 0.5F, 1e-6F);
  }
  EXPECT_NEAR(checker().sample({1.25F, -0.75F}).x, 0, 1e-6F);
}

TEST(Texture, DecodesSrgb) {
  const Texture grey{"grey", 1, 1, {188, 0, 255}};
  EXPECT_NEAR(grey.sample({0.3F, 0.9F}).x, std::pow((188 / 255.0F + 0.055F) / 1.055F, 2.4F), 1e-6F);
  EXPECT_NEAR(grey.sample({0.3F, 0.9F}).z, 1, 1e-6F);
}

TEST(Texture, AnyCoordinateIsInside) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (const float u : {0.0F, 1.0F, -1e-30F, 1e30F, -1e30F, inf, -inf, std::nanf("")}) {
    const float value = checker().sample({u, 0.3F}).x;
    EXPECT_TRUE(value >= 0 && value <= 1) << u;
  }
}

Scene two_triangles() {
  Scene scene;
  scene.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  scene.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.mesh.material = {0, 1};
  scene.mesh.object = {0, 0};
  scene.mesh.two_sided = {0, 1};
  scene.materials.resize(2);
  return scene;
}

TEST(Scene, HashDependsOnWhatRaysSeeAndOnNothingElse) {
  const std::uint64_t hash = two_triangles().geometry_hash();
  EXPECT_EQ(two_triangles().geometry_hash(), hash);

  Scene scene = two_triangles();
  scene.materials[0].reflectance = Rgb(0.1F);
  scene.objects.push_back({"thing"});
  EXPECT_EQ(scene.geometry_hash(), hash);

  scene = two_triangles();
  scene.mesh.positions[3].x = std::nextafter(0.0F, 1.0F);
  EXPECT_NE(scene.geometry_hash(), hash);
  scene = two_triangles();
  std::swap(scene.mesh.triangles[1][0], scene.mesh.triangles[1][1]);
  EXPECT_NE(scene.geometry_hash(), hash);
  scene = two_triangles();
  scene.mesh.two_sided[1] = 0;
  EXPECT_NE(scene.geometry_hash(), hash);
}

TEST(Scene, HashSeesEveryVertexOfALargeMesh) {
  Scene scene;
  scene.mesh.positions.resize(200'003);
  const std::uint64_t hash = scene.geometry_hash();
  for (const std::size_t i :
       {std::size_t{0}, std::size_t{65'535}, std::size_t{65'536}, std::size_t{200'002}}) {
    scene.mesh.positions[i].y = 1;
    EXPECT_NE(scene.geometry_hash(), hash) << i;
    scene.mesh.positions[i].y = 0;
  }
}

TEST(Scene, ReflectanceIsTheFactorTimesTheTexture) {
  Scene scene = two_triangles();
  scene.materials[0].reflectance = Rgb(0.5F, 0.25F, 0.75F);
  EXPECT_EQ(scene.reflectance(0, 0.3F, 0.3F), Rgb(0.5F, 0.25F, 0.75F));
  scene.materials[0].texture = 0;
  scene.textures.push_back(checker());
  scene.texcoords = {{0.25F, 0.25F}, {0.75F, 0.25F}, {0.25F, 0.75F}, {}};
  EXPECT_EQ(scene.reflectance(0, 0, 0), Rgb(0.0F));
  EXPECT_EQ(scene.reflectance(0, 1, 0), Rgb(0.5F, 0.25F, 0.75F));
}

}  // namespace
}  // namespace relumbre
