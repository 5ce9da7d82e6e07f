/// Direct irradiance at the points that pixels see.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "relumbre/render/light_sampler.h"

namespace relumbre {

/// One of a pixel's samples.
struct PixelSample {
  Receiver receiver{};
  std::size_t pixel = 0;
  std::uint32_t index = 0;  ///< among the pixel's samples
  bool lit = false;         ///< false: nothing was hit, there is nothing to light
};

/// All lights of a scene that are on, sampled by shadow rays. Immutable and thread-safe.
class PixelLight {
 public:
  /// Each sample shoots one ray at a light without extent, and as many at others as make
  /// `light_samples` a pixel. The scene and rays must outlive this. Throws what
  /// make_light_sampler throws.
  PixelLight(const Scene& scene, const RayScene& rays, std::span<const Light> lights,
             std::uint32_t samples, std::uint32_t light_samples, std::uint64_t seed);

  /// irradiance[i] = what arrives at samples[i], W/m²; 0 where it is not lit. Depends on each
  /// sample alone.
  void gather(std::span<const PixelSample> samples, std::span<Rgb> irradiance) const;

 private:
  struct Source {
    std::unique_ptr<LightSampler> sampler;
    Rgb power;
    std::uint32_t rays;  ///< a sample
    std::uint64_t seed;
  };
  void add(const Source& source, std::span<const PixelSample> samples,
           std::span<Rgb> irradiance) const;

  const RayScene& rays_;
  std::vector<Source> sources_;
};

}  // namespace relumbre
