#include "relumbre/render/direct_light.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/render/element_points.h"
#include "relumbre/render/light_sampler.h"

namespace relumbre {

namespace {

/// Rays traced together, unless the tracer wants more: enough to keep it busy, few enough to stay
/// in the caches.
constexpr std::size_t kBatch = 2048;
/// Times as many for an element that the light's power hinges on.
constexpr std::size_t kMoreRays = 16;

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

/// Of the mean luminance, were the rays independent.
double standard_error(std::span<const Rgb> values) {
  const auto expected = static_cast<double>(luminance(mean(values)));
  double squares = 0;
  for (const Rgb& v : values) {
    const double d = static_cast<double>(luminance(v)) - expected;
    squares += d * d;
  }
  const auto count = static_cast<double>(values.size());
  return std::sqrt(squares / count / std::max(count - 1, 1.0));
}

/// What rays say of the irradiance of an element.
struct Estimate {
  Rgb irradiance;
  double error = 0;  ///< standard error of its luminance
};

/// Shoots rays from elements at one light.
class ElementLight {
 public:
  ElementLight(const Tessellation& tessellation, const RayScene& rays, const LightSampler& sampler,
               std::uint64_t seed)
      : tessellation_(tessellation), rays_(rays), sampler_(sampler), seed_(seed) {}

  /// estimates[i] of elements[i], from so many rays each. `ahead`: told of every element done.
  template <class Ahead>
  void estimate(std::span<const std::uint32_t> elements, std::size_t rays,
                std::span<Estimate> estimates, Ahead&& ahead) {
    const std::size_t batch_rays = std::max(kBatch, rays_.preferred_batch());
    parallel_chunks(0, elements.size(), std::max<std::size_t>(1, batch_rays / rays),
                    [&](std::size_t first, std::size_t last) {
                      std::vector<LightRay> batch((last - first) * rays);
                      std::vector<Rgb> arriving(batch.size());
                      const auto of = [&](auto& values, std::size_t i) {
                        return std::span(values).subspan((i - first) * rays, rays);
                      };
                      for (std::size_t i = first; i < last; ++i)
                        sample_element(tessellation_, elements[i], sampler_, rays_.epsilon(), seed_,
                                       of(batch, i));
                      cast_ += trace_light_rays(rays_, sampler_, batch, arriving);
                      for (std::size_t i = first; i < last; ++i)
                        estimates[i] = {mean(of(arriving, i)), standard_error(of(arriving, i))};
                      ahead(last - first);
                    });
  }
  [[nodiscard]] std::uint64_t cast() const { return cast_; }

 private:
  const Tessellation& tessellation_;
  const RayScene& rays_;
  const LightSampler& sampler_;
  std::uint64_t seed_;
  std::atomic<std::uint64_t> cast_ = 0;
};

/// Elements whose error, times their area, is more than this share of all that arrives.
std::vector<std::uint32_t> uncertain_elements(std::span<const Estimate> estimates,
                                              std::span<const float> area) {
  constexpr double kShare = 5e-5;
  double whole = 0;
  for (std::size_t i = 0; i < area.size(); ++i)
    whole += static_cast<double>(area[i] * luminance(estimates[i].irradiance));
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < area.size(); ++i)
    if (static_cast<double>(area[i]) * estimates[i].error > kShare * whole)
      result.push_back(static_cast<std::uint32_t>(i));
  return result;
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
  progress.begin("direct light of " + light.name, n);
  const auto ahead = [&progress](std::size_t elements) {
    progress.check();
    progress.advance(elements);
  };

  // Every element with few rays; then those that matter and are uncertain, anew, with many.
  ElementLight element_light(tessellation, rays, *sampler, config.seed);
  std::vector<std::uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0U);
  std::vector<Estimate> estimates(n);
  element_light.estimate(all, per_element, estimates, ahead);
  const auto uncertain = uncertain_elements(estimates, tessellation.area);
  std::vector<Estimate> better(uncertain.size());
  element_light.estimate(uncertain, per_element * kMoreRays, better,
                         [&progress](std::size_t) { progress.check(); });

  std::vector<Rgb> response(n);
  for (std::size_t i = 0; i < n; ++i) response[i] = estimates[i].irradiance;
  for (std::size_t i = 0; i < uncertain.size(); ++i) response[uncertain[i]] = better[i].irradiance;
  if (rays_cast != nullptr) *rays_cast += element_light.cast();
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
