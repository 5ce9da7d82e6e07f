/// Internal: how layers from front to back cover one another.
#pragma once

#include <algorithm>
#include <vector>

#include "relumbre/dof/depth_picture.h"

namespace relumbre {

/// Share of a pixel that blurs of a total weight cover. Where circles of confusion change from
/// pixel to pixel, the weights of one surface add up to a little less than 1, and what lies behind,
/// perhaps a thousand times as bright, must not shine through that. `tolerance` is what may be
/// missing.
inline double covered(double weight, double tolerance) {
  const double trusted = 1 - 4 * tolerance, full = 1 - tolerance;
  if (weight <= trusted) return weight;
  return std::min(trusted + (weight - trusted) * (1 - trusted) / (full - trusted), 1.0);
}

/// Blurs of a few pixels are cut off by the pixels they fall on; large ones add up smoothly.
inline double tolerance_of(double diameter) {
  return std::clamp(0.06 - 0.018 * (diameter - 2), 0.02, 0.06);
}

/// Layers laid over one another from front to back.
class Cover {
 public:
  explicit Cover(std::size_t pixels) : color_(pixels), weight_(pixels), share_(pixels) {}

  /// Puts the sums of the next layer behind what is there.
  void add(std::size_t pixel, const Rgba& sum, double weight, double tolerance) {
    constexpr double kNothing = 1e-9;
    if (weight < kNothing || share_[pixel] >= 1) return;
    weight_[pixel] += weight;
    const double taken = std::max(covered(weight_[pixel], tolerance) - share_[pixel], 0.0);
    share_[pixel] += taken;
    const auto scale = static_cast<float>(taken / weight);
    Rgba& c = color_[pixel];
    c.r += sum.r * scale, c.g += sum.g * scale, c.b += sum.b * scale, c.a += sum.a * scale;
  }
  /// What nothing has covered is taken to look like the rest of the pixel.
  [[nodiscard]] Rgba color(std::size_t pixel) const {
    if (share_[pixel] <= 0) return {};
    const auto scale = static_cast<float>(1 / share_[pixel]);
    const Rgba c = color_[pixel];
    return {c.r * scale, c.g * scale, c.b * scale, c.a * scale};
  }

 private:
  std::vector<Rgba> color_;
  std::vector<double> weight_, share_;
};

}  // namespace relumbre
