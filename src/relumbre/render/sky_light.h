/// Light from a latitude-longitude radiance image.
#pragma once

#include <memory>
#include <vector>

#include "relumbre/render/discrete_choice.h"
#include "relumbre/render/light_sampler.h"

namespace relumbre {

/// Radiance by direction. Row 0 touches +y; the image's centre looks towards −z and its columns run
/// towards +x; rotation_deg turns it counter-clockwise as seen from above. A texel's radiance is
/// constant over it.
class SkyMap {
 public:
  /// Throws ValueError naming the light if it has no image, or one with values that are not finite.
  /// Negative values, which resampling filters leave behind, count as 0.
  explicit SkyMap(const Light& light);

  /// W/m²/sr from a unit direction that points towards the sky.
  [[nodiscard]] Rgb radiance(const Vec3f& direction) const;
  /// Density of sample() in solid angle, 1/sr: proportional to luminance.
  [[nodiscard]] float density(const Vec3f& direction) const;
  /// A direction chosen by luminance. Not for a black sky.
  [[nodiscard]] Vec3f sample(float u, float v) const;
  [[nodiscard]] bool black() const { return !(rows_.total() > 0); }

 private:
  struct Texel {
    std::size_t column, row;
  };
  [[nodiscard]] Texel texel(const Vec3f& direction) const;
  [[nodiscard]] const Rgb& at(const Texel& t) const { return texels_[t.row * width_ + t.column]; }

  std::size_t width_ = 0, height_ = 0;
  float turn_ = 0;                       ///< rotation, as a fraction of a full turn
  std::vector<Rgb> texels_;              ///< row-major, none below 0
  DiscreteChoice rows_;                  ///< by luminance · solid angle
  std::vector<DiscreteChoice> columns_;  ///< of each row, by luminance
};

/// Throws what SkyMap throws.
std::unique_ptr<LightSampler> make_sky_sampler(const Light& light);

}  // namespace relumbre
