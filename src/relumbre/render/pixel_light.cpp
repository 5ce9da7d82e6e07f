#include "relumbre/render/pixel_light.h"

#include "relumbre/base/sampling.h"
#include "relumbre/render/element_points.h"

namespace relumbre {

PixelLight::PixelLight(const Scene& scene, const RayScene& rays, std::span<const Light> lights,
                       std::uint32_t samples, std::uint32_t light_samples, std::uint64_t seed)
    : rays_(rays) {
  const std::uint32_t several = std::max(1U, (light_samples + samples - 1) / samples);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].power() == Rgb{}) continue;
    auto sampler = make_light_sampler(scene, lights[i], rays.epsilon());
    const std::uint32_t per_sample = sampler->has_no_extent() ? 1 : several;
    sources_.push_back({std::move(sampler), lights[i].power(), per_sample, hash64(seed, i + 1)});
  }
}

void PixelLight::gather(std::span<const PixelSample> samples, std::span<Rgb> irradiance) const {
  std::fill(irradiance.begin(), irradiance.end(), Rgb{});
  for (const Source& source : sources_) add(source, samples, irradiance);
}

void PixelLight::add(const Source& source, std::span<const PixelSample> samples,
                     std::span<Rgb> irradiance) const {
  std::vector<LightRay> batch(samples.size() * source.rays);
  std::vector<Rgb> arriving(batch.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].lit) continue;
    const ScrambledSobol sobol(hash64(source.seed, samples[i].pixel));
    for (std::uint32_t r = 0; r < source.rays; ++r) {
      const std::array<float, 4> u = sobol(samples[i].index * source.rays + r);
      batch[i * source.rays + r] = source.sampler->sample(samples[i].receiver, u[2], u[3]);
    }
  }
  trace_light_rays(rays_, *source.sampler, batch, arriving);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Rgb sum;
    for (std::uint32_t r = 0; r < source.rays; ++r) sum += arriving[i * source.rays + r];
    irradiance[i] += source.power * sum / static_cast<float>(source.rays);
  }
}

}  // namespace relumbre
