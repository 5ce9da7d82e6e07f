/// Direct irradiance of elements, by shadow rays.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/scene/scene.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

struct DirectLightConfig {
  std::uint32_t points_per_element = 16;  ///< quasi-random; powers of two are stratified best
  /// For lights with a surface, as many rays a point are shot (each from a point of its own).
  std::uint32_t light_samples = 4;
  std::uint32_t sky_samples = 16;  ///< the same for skies, which are seen through small openings
  std::uint64_t seed = 1;

  /// Rays that one element gets from a light. Throws ValueError if a figure is 0, or the product is
  /// above 2^20.
  [[nodiscard]] std::uint32_t rays_per_element(LightType type) const;
};

/// Irradiance in W/m² of every element (n) from one light at unit power: color · intensity = 1 and
/// on, whatever the light says of those. So irradiance is power() times this. Occluders are
/// whatever `rays` holds; an element is lit from the side it faces. Elements that the light's
/// arriving power hinges on, such as those of a shade around its bulb, whose first rays disagree,
/// get 16 times as many. The same for any number of threads. Adds the number of rays cast to
/// *rays_cast, if given. Throws what make_light_sampler throws, and Cancelled.
std::vector<Rgb> light_response(const Scene& scene, const Tessellation& tessellation,
                                const RayScene& rays, const Light& light,
                                const DirectLightConfig& config = {},
                                Progress& progress = no_progress(),
                                std::uint64_t* rays_cast = nullptr);

/// What a light does to every element at unit power. Shared, because caches hold it too.
using LightResponse = std::shared_ptr<const std::vector<Rgb>>;

/// Σ power · response over the lights, W/m² per element (n). Lights that are off cost nothing.
/// Throws ShapeError if there are not as many responses as lights, or one is not of n values.
std::vector<Rgb> direct_irradiance(std::size_t elements, std::span<const Light> lights,
                                   std::span<const LightResponse> responses);

}  // namespace relumbre
