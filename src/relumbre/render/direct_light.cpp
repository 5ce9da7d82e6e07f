#include "relumbre/render/direct_light.h"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/render/element_points.h"
#include "relumbre/render/light_sampler.h"

namespace relumbre {

namespace {

/// Rays traced together: enough to keep the ray tracer busy, few enough to stay in the caches.
constexpr std::size_t kBatch = 2048;

/// All rays of element i. Those of a degenerate element stay as they are: not worth tracing.
void sample_element(const Tessellation& tessellation, std::size_t i, const LightSampler& sampler,
                    float epsilon, std::uint64_t seed, std::span<LightRay> out) {
  const ElementPoints points(tessellation, i, epsilon);
  if (!points.any()) return;
  const ScrambledSobol sobol(hash64(seed, i));
  for (std::uint32_t s = 0; s < out.size(); ++s) {
    const std::array<float, 4> u = sobol(s);
    out[s] = sampler.sample(points.at(u[0], u[1]), u[2], u[3]);
  }
}

Rgb mean(std::span<const Rgb> values) {
  Vec3d sum;
  for (const Rgb& v : values) sum += Vec3d(v);
  return Rgb(sum / static_cast<double>(values.size()));
}

}  // namespace

std::uint32_t DirectLightConfig::rays_per_element(LightType type) const {
  const std::uint64_t samples = type == LightType::kSky ? sky_samples
                                : type == LightType::kQuad || type == LightType::kEmitter
                                    ? light_samples
                                    : 1;
  const std::uint64_t total = samples * points_per_element;
  if (total == 0 || total > (1U << 20)) {
    throw ValueError(
        fmt::format("direct light: {} points of {} samples an element; the product must "
                    "be 1 to 2^20",
                    points_per_element, samples));
  }
  return static_cast<std::uint32_t>(total);
}

std::vector<Rgb> light_response(const Scene& scene, const Tessellation& tessellation,
                                const RayScene& rays, const Light& light,
                                const DirectLightConfig& config, Progress& progress,
                                std::uint64_t* rays_cast) {
  const auto sampler = make_light_sampler(scene, light, rays.epsilon());
  const std::size_t per_element = config.rays_per_element(light.type);
  const std::size_t n = tessellation.elements();
  std::vector<Rgb> response(n);
  std::atomic<std::uint64_t> cast = 0;
  progress.begin("direct light of " + light.name, n);
  parallel_chunks(
      0, n, std::max<std::size_t>(1, kBatch / per_element),
      [&](std::size_t first, std::size_t last) {
        progress.check();
        std::vector<LightRay> batch((last - first) * per_element);
        std::vector<Rgb> arriving(batch.size());
        for (std::size_t i = first; i < last; ++i) {
          sample_element(tessellation, i, *sampler, rays.epsilon(), config.seed,
                         std::span(batch).subspan((i - first) * per_element, per_element));
        }
        cast += trace_light_rays(rays, *sampler, batch, arriving);
        for (std::size_t i = first; i < last; ++i) {
          response[i] = mean(std::span(arriving).subspan((i - first) * per_element, per_element));
        }
        progress.advance(last - first);
      });
  if (rays_cast != nullptr) *rays_cast += cast;
  return response;
}

std::vector<Rgb> direct_irradiance(std::size_t elements, std::span<const Light> lights,
                                   std::span<const LightResponse> responses) {
  if (lights.size() != responses.size()) {
    throw ShapeError(
        fmt::format("direct light: {} responses for {} lights", responses.size(), lights.size()));
  }
  std::vector<Rgb> total(elements);
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const std::vector<Rgb>& response = *responses[l];
    if (response.size() != elements) {
      throw ShapeError(
          fmt::format("direct light: the response of '{}' has {} values for {} elements",
                      lights[l].name, response.size(), elements));
    }
    const Rgb power = lights[l].power();
    if (power == Rgb{}) continue;
    parallel_for(0, elements, 8192, [&](std::size_t i) { total[i] += response[i] * power; });
  }
  return total;
}

}  // namespace relumbre
