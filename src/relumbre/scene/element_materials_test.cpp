#include "relumbre/scene/element_materials.h"

#include <cmath>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

/// A unit square of two triangles with texture coordinates repeated `tiles` times, material 0
/// textured; beside it a plain triangle of material 1 that emits.
Scene textured_square(float tiles, Texture texture) {
  Scene scene;
  scene.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                          {2, 0, 0}, {3, 0, 0}, {2, 1, 0}};
  scene.mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
  scene.mesh.material = {0, 0, 1};
  scene.mesh.object = {0, 0, 0};
  scene.mesh.two_sided = {0, 1, 0};
  scene.texcoords = {{0, 0}, {tiles, 0}, {tiles, tiles}, {0, tiles}, {}, {}, {}};
  scene.materials.resize(2);
  scene.materials[0].reflectance = Rgb(0.8F, 0.4F, 0.2F);
  scene.materials[0].texture = 0;
  scene.materials[1].reflectance = Rgb(0.1F, 0.2F, 0.3F);
  scene.materials[1].emission = Rgb(5, 6, 7);
  scene.textures.push_back(std::move(texture));
  return scene;
}

Texture noise(std::uint32_t size) {
  Texture texture{"noise", size, size, std::vector<std::uint8_t>(std::size_t{3} * size * size)};
  RandomStream random(7);
  for (std::uint8_t& byte : texture.rgb) byte = static_cast<std::uint8_t>(random.bits() & 255);
  return texture;
}

Tessellation cut(const Scene& scene, std::size_t patches, std::size_t elements) {
  TessellationConfig config;
  config.patches = patches;
  config.elements = elements;
  return tessellate(scene.mesh, config);
}

/// The obvious twin: a fine grid of points over each facet, found by inverting its corners.
Rgb brute_force(const Scene& scene, const Tessellation& tessellation, std::size_t element) {
  Vec3d sum;
  double area = 0;
  constexpr int steps = 60;
  for (const Facet& facet : tessellation.facets_of(element)) {
    const Vec3d a(tessellation.positions[facet.corners[0]]),
        b(tessellation.positions[facet.corners[1]]), c(tessellation.positions[facet.corners[2]]);
    const Vec3d p(scene.mesh.corner(facet.triangle, 0));
    const Vec3d e1 = Vec3d(scene.mesh.corner(facet.triangle, 1)) - p;
    const Vec3d e2 = Vec3d(scene.mesh.corner(facet.triangle, 2)) - p;
    const Vec3d n = cross(e1, e2);
    Vec3d facet_sum;
    int points = 0;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; i + j < steps; ++j, ++points) {
        const Vec3d x =
            a + (b - a) * ((i + 1.0 / 3) / steps) + (c - a) * ((j + 1.0 / 3) / steps) - p;
        facet_sum += Vec3d(scene.reflectance(facet.triangle,
                                             static_cast<float>(dot(cross(x, e2), n) / dot(n, n)),
                                             static_cast<float>(dot(cross(e1, x), n) / dot(n, n))));
      }
    }
    const double weight = length(cross(b - a, c - a));
    sum += facet_sum * (weight / points);
    area += weight;
  }
  return Rgb(sum / area);
}

TEST(ElementMaterials, PlainMaterialsPassThrough) {
  Scene scene = textured_square(1, noise(4));
  scene.materials[0].texture = kNone;
  const Tessellation tessellation = cut(scene, 7, 53);
  const ElementMaterials materials = element_materials(scene, tessellation);
  ASSERT_EQ(materials.reflectance.size(), 53U);
  for (std::size_t i = 0; i < 53; ++i) {
    const bool emitter = tessellation.centroid[i].x > 1.5F;
    const Material& expected = scene.materials[emitter ? 1 : 0];
    EXPECT_LE(length(materials.reflectance[i] - expected.reflectance), 1e-6F);
    EXPECT_LE(length(materials.emission[i] - expected.emission), 1e-5F);
  }
}

TEST(ElementMaterials, TexturesAreAveragedOverEachElement) {
  for (const float tiles : {0.3F, 1.0F, 5.0F}) {
    const Scene scene = textured_square(tiles, noise(8));
    const Tessellation tessellation = cut(scene, 5, 41);
    const ElementMaterials materials = element_materials(scene, tessellation);
    for (std::size_t i = 0; i < tessellation.elements(); ++i) {
      if (tessellation.centroid[i].x > 1.5F) continue;
      const Rgb expected = brute_force(scene, tessellation, i);
      EXPECT_LE(length(materials.reflectance[i] - expected), 0.06F) << tiles << " element " << i;
    }
  }
}

TEST(ElementMaterials, VertexColoursAreAveragedWithAndWithoutTextures) {
  for (const bool textured : {false, true}) {
    Scene scene = textured_square(1, {"grey", 1, 1, {128, 128, 128}});
    if (!textured) scene.materials[0].texture = kNone;
    scene.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, Rgb(1), Rgb(0.5F), Rgb(0)};
    const Tessellation tessellation = cut(scene, 5, 41);
    const ElementMaterials materials = element_materials(scene, tessellation);
    for (std::size_t i = 0; i < tessellation.elements(); ++i) {
      const Rgb expected = brute_force(scene, tessellation, i);
      EXPECT_LE(length(materials.reflectance[i] - expected), textured ? 0.02F : 1e-4F) << i;
    }
  }
}

TEST(ElementMaterials, MixedElementsAreWeighedByArea) {
  const Scene scene = textured_square(1, {"white", 1, 1, {255, 255, 255}});
  // One patch and one element hold the square's front, the back of its upper half, and the
  // triangle: areas 1, ½ and ½.
  const ElementMaterials materials = element_materials(scene, cut(scene, 1, 1));
  const Rgb expected =
      scene.materials[0].reflectance * 0.75F + scene.materials[1].reflectance * 0.25F;
  EXPECT_LE(length(materials.reflectance[0] - expected), 1e-5F);
  EXPECT_LE(length(materials.emission[0] - Rgb(5, 6, 7) * 0.25F), 1e-5F);
}

TEST(ElementMaterials, WhiteTextureStaysBelowOne) {
  Scene scene = textured_square(1, {"white", 1, 1, {255, 255, 255}});
  scene.materials[0].reflectance = Rgb(kMaxReflectance);
  for (const Rgb& rho : element_materials(scene, cut(scene, 3, 11)).reflectance) {
    EXPECT_LE(max_component(rho), kMaxReflectance);
  }
}

}  // namespace
}  // namespace relumbre
