#include "relumbre/render/relight.h"

#include <limits>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

static_assert(sizeof(Rgb) == 3 * sizeof(float), "operators take interleaved RGB");

namespace {

constexpr std::size_t kGrain = 8192;

void require_size(std::string_view what, std::size_t size, std::size_t elements) {
  if (size == elements) return;
  throw ShapeError(fmt::format("relight: {} {} values for {} elements", size, what, elements));
}

std::span<float> floats(std::vector<Rgb>& values) {
  return {reinterpret_cast<float*>(values.data()), values.size() * 3};
}

/// a / b where b > 0, else 1: a factor that leaves nothing at nothing.
float ratio(double a, double b) { return b > 0 ? static_cast<float>(a / b) : 1.0F; }

/// How much of an element's emission its facets' objects are set to.
Rgb emission_scale(const Scene& scene, const Tessellation& tessellation, std::size_t element,
                   std::span<const Rgb> object_power) {
  Vec3d set, full;
  for (const Facet& facet : tessellation.facets_of(element)) {
    const Vec3f a = tessellation.positions[facet.corners[0]];
    const float area = length(cross(tessellation.positions[facet.corners[1]] - a,
                                    tessellation.positions[facet.corners[2]] - a));
    const Rgb flux = scene.material_of(facet.triangle).emission * area;
    full += Vec3d(flux);
    set += Vec3d(flux * object_power[scene.mesh.object[facet.triangle]]);
  }
  return {ratio(set.x, full.x), ratio(set.y, full.y), ratio(set.z, full.z)};
}

}  // namespace

std::vector<Rgb> object_powers(const Scene& scene, std::span<const Light> lights) {
  std::vector<Rgb> powers(scene.objects.size());
  for (const Light& light : lights) {
    if (light.type == LightType::kEmitter && light.object < powers.size()) {
      powers[light.object] += light.power();
    }
  }
  return powers;
}

std::vector<Rgb> scaled_emission(const Scene& scene, const Tessellation& tessellation,
                                 std::span<const Rgb> emission, std::span<const Light> lights) {
  require_size("emission", emission.size(), tessellation.elements());
  const std::vector<Rgb> powers = object_powers(scene, lights);
  std::vector<Rgb> scaled(emission.begin(), emission.end());
  parallel_for(0, scaled.size(), kGrain, [&](std::size_t i) {
    if (scaled[i] != Rgb{}) scaled[i] *= emission_scale(scene, tessellation, i, powers);
  });
  return scaled;
}

RelitResult relight(const Scene& scene, const Tessellation& tessellation,
                    std::span<const Rgb> reflectance, std::span<const Rgb> emission,
                    const RelightOperator& relight_operator, std::span<const Light> lights,
                    std::span<const LightResponse> responses) {
  const std::size_t n = tessellation.elements();
  require_size("reflectance", reflectance.size(), n);
  RelitResult lit;
  lit.emission = scaled_emission(scene, tessellation, emission, lights);
  lit.direct_irradiance = direct_irradiance(n, lights, responses);

  // What direct light makes of every element, then all that it becomes.
  lit.radiosity.resize(n);
  parallel_for(0, n, kGrain, [&](std::size_t i) {
    lit.radiosity[i] = reflectance[i] * lit.direct_irradiance[i];
  });
  relight_operator.apply(floats(lit.radiosity), floats(lit.radiosity));
  parallel_for(0, n, kGrain, [&](std::size_t i) { lit.radiosity[i] += lit.emission[i]; });
  return lit;
}

std::vector<Rgb> total_irradiance(const RelitResult& lit, std::span<const Rgb> reflectance) {
  require_size("reflectance", reflectance.size(), lit.radiosity.size());
  require_size("emission", lit.emission.size(), lit.radiosity.size());
  std::vector<Rgb> irradiance(lit.radiosity.size());
  parallel_for(0, irradiance.size(), kGrain, [&](std::size_t i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float rho = reflectance[i][c];
      irradiance[i][c] = rho > 0 ? (lit.radiosity[i][c] - lit.emission[i][c]) / rho
                                 : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return irradiance;
}

std::vector<Rgb> indirect_irradiance(const RelitResult& lit, std::span<const Rgb> reflectance) {
  std::vector<Rgb> irradiance = total_irradiance(lit, reflectance);
  require_size("direct irradiance", lit.direct_irradiance.size(), irradiance.size());
  // Rounding may leave a little less than nothing.
  parallel_for(0, irradiance.size(), kGrain, [&](std::size_t i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float rest = irradiance[i][c] - lit.direct_irradiance[i][c];
      irradiance[i][c] = rest < 0 ? 0 : rest;
    }
  });
  return irradiance;
}

}  // namespace relumbre
