#include "relumbre/scene/element_materials.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/geometry/facet.h"

namespace relumbre {
namespace {

constexpr std::size_t kGrain = 256;
constexpr std::uint32_t kFewestSamples = 8, kMostSamples = 4096;

/// Barycentrics of a point of the facet, from those of its corners.
Vec2f interpolate(const std::array<Vec2f, 3>& corners, Vec2f at) {
  return corners[0] * (1 - at.x - at.y) + corners[1] * at.x + corners[2] * at.y;
}

/// Points to take on a facet: as many as the texels it covers, rounded up to a power of two, for
/// such runs of the sequence are stratified.
std::uint32_t sample_count(const Scene& scene, std::uint32_t triangle,
                           const std::array<Vec2f, 3>& corners) {
  const Texture& texture = scene.textures[scene.material_of(triangle).texture];
  const Index3& vertices = scene.mesh.triangles[triangle];
  const auto texel = [&](Vec2f barycentric) {
    const Vec2f uv = scene.texcoords[vertices[0]] * (1 - barycentric.x - barycentric.y) +
                     scene.texcoords[vertices[1]] * barycentric.x +
                     scene.texcoords[vertices[2]] * barycentric.y;
    return Vec2f{uv.x * static_cast<float>(texture.width),
                 uv.y * static_cast<float>(texture.height)};
  };
  const Vec2f a = texel(corners[0]);
  const Vec2f ab = texel(corners[1]) + a * -1, ac = texel(corners[2]) + a * -1;
  const float texels = std::abs(ab.x * ac.y - ab.y * ac.x) / 2;
  // Negated, so that a footprint that overflows to infinity or NaN takes the most.
  if (!(texels < static_cast<float>(kMostSamples))) return kMostSamples;
  return std::bit_ceil(std::max(kFewestSamples, static_cast<std::uint32_t>(texels)));
}

Rgb mean_reflectance(const Scene& scene, const Tessellation& tessellation, const Facet& facet) {
  const Material& material = scene.material_of(facet.triangle);
  const bool textured = material.texture != kNone && !scene.texcoords.empty();
  if (!textured && scene.colors.empty()) return material.reflectance;
  const std::array<Vec2f, 3> corners = facet_barycentrics(scene.mesh, facet, tessellation);
  if (!textured) {  // colours are linear over a facet: their mean is that of its centre
    const Vec2f center = interpolate(corners, {1.0F / 3, 1.0F / 3});
    return scene.reflectance(facet.triangle, center.x, center.y);
  }
  const std::uint32_t samples = sample_count(scene, facet.triangle, corners);
  Vec3d sum;
  for (std::uint32_t s = 0; s < samples; ++s) {
    const auto [x, y, unused_z, unused_w] = sobol4(s);
    const Vec2f at = interpolate(corners, square_to_triangle(to_unit(x), to_unit(y)));
    sum += Vec3d(scene.reflectance(facet.triangle, at.x, at.y));
  }
  return Rgb(sum / static_cast<double>(samples));
}

double area_of(const Tessellation& tessellation, const Facet& facet) {
  const Vec3d a(tessellation.positions[facet.corners[0]]);
  const Vec3d b(tessellation.positions[facet.corners[1]]);
  const Vec3d c(tessellation.positions[facet.corners[2]]);
  return length(cross(b - a, c - a)) / 2;
}

}  // namespace

ElementMaterials element_materials(const Scene& scene, const Tessellation& tessellation) {
  const std::size_t n = tessellation.elements();
  ElementMaterials result{std::vector<Rgb>(n), std::vector<Rgb>(n)};
  parallel_for(0, n, kGrain, [&](std::size_t i) {
    Vec3d reflectance, emission;
    double area = 0;
    for (const Facet& facet : tessellation.facets_of(i)) {
      const double weight = area_of(tessellation, facet);
      reflectance += Vec3d(mean_reflectance(scene, tessellation, facet)) * weight;
      emission += Vec3d(scene.material_of(facet.triangle).emission) * weight;
      area += weight;
    }
    if (!(area > 0)) return;
    result.reflectance[i] = min(Rgb(reflectance / area), Rgb(kMaxReflectance));
    result.emission[i] = Rgb(emission / area);
  });
  return result;
}

}  // namespace relumbre
