/// Internal: how layers from front to back cover one another.
#pragma once

#include <algorithm>
#include <vector>

#include "relumbre/base/host_device.h"
#include "relumbre/dof/depth_picture.h"

namespace relumbre {

/// Share of a pixel that blurs of a total weight cover. Where circles of confusion change from
/// pixel to pixel, the weights of one surface add up to a little less than 1, and what lies behind,
/// perhaps a thousand times as bright, must not shine through that. `tolerance` is what may be
/// missing.
RELUMBRE_HOST_DEVICE inline double covered(double weight, double tolerance) {
  const double trusted = 1 - 4 * tolerance, full = 1 - tolerance;
  if (weight <= trusted) return weight;
  return std::min(trusted + (weight - trusted) * (1 - trusted) / (full - trusted), 1.0);
}

/// Blurs of a few pixels are cut off by the pixels they fall on; large ones add up smoothly.
RELUMBRE_HOST_DEVICE inline double tolerance_of(double diameter) {
  return std::clamp(0.06 - 0.018 * (diameter - 2), 0.02, 0.06);
}

/// What of a pixel is known so far.
struct PixelCover {
  Rgba& color;
  double &weight, &share;

  /// Puts the sums of the next layer behind what is there.
  RELUMBRE_HOST_DEVICE void add(const Rgba& sum, double of_sum, double tolerance) const {
    constexpr double kNothing = 1e-9;
    if (of_sum < kNothing || share >= 1) return;
    weight += of_sum;
    const double taken = std::max(covered(weight, tolerance) - share, 0.0);
    share += taken;
    const auto scale = static_cast<float>(taken / of_sum);
    color.r += sum.r * scale, color.g += sum.g * scale;
    color.b += sum.b * scale, color.a += sum.a * scale;
  }
  /// What nothing has covered is taken to look like the rest of the pixel.
  [[nodiscard]] RELUMBRE_HOST_DEVICE Rgba whole() const {
    if (share <= 0) return {};
    const auto scale = static_cast<float>(1 / share);
    return {color.r * scale, color.g * scale, color.b * scale, color.a * scale};
  }
};

/// Layers laid over one another from front to back.
class Cover {
 public:
  explicit Cover(std::size_t pixels) : color_(pixels), weight_(pixels), share_(pixels) {}

  /// Puts the sums of the next layer behind what is there.
  void add(std::size_t pixel, const Rgba& sum, double weight, double tolerance) {
    at(pixel).add(sum, weight, tolerance);
  }
  [[nodiscard]] Rgba color(std::size_t pixel) { return at(pixel).whole(); }

 private:
  [[nodiscard]] PixelCover at(std::size_t pixel) {
    return {color_[pixel], weight_[pixel], share_[pixel]};
  }

  std::vector<Rgba> color_;
  std::vector<double> weight_, share_;
};

}  // namespace relumbre
