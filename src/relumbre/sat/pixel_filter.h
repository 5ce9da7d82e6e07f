/// The box filter of one pixel. Host and device.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "relumbre/sat/box_reader.h"

namespace relumbre {

inline constexpr double kLargestRadius = 1 << 20;

/// Pixels of the image that a square of this radius can cover.
inline std::size_t covered_pixels(double radius, std::size_t width, std::size_t height) {
  const std::size_t side = 2 * static_cast<std::size_t>(std::ceil(radius)) + 1;
  return std::min(side, width) * std::min(side, height);
}

/// Filters the pixels of one table. Nothing is checked: radii are from 0 to kLargestRadius, squares
/// of fixed kinds no larger than the largest box. The reader must outlive it.
template <class Reader>
class PixelFilter {
 public:
  RELUMBRE_HOST_DEVICE PixelFilter(const Reader& reader, const BorderRule& border)
      : reader_(reader), border_(border) {}

  /// The mean over the square of side 2 · radius + 1 about the centre of pixel (x, y).
  [[nodiscard]] RELUMBRE_HOST_DEVICE SatSums mean(std::size_t x, std::size_t y,
                                                  double radius) const {
    const SatLayout& layout = reader_.layout();
    const auto whole = static_cast<std::size_t>(radius);
    const double rest = radius - static_cast<double>(whole);
    const std::size_t reach = whole + (rest > 0 ? 1 : 0);
    const bool inside =
        x >= reach && y >= reach && x + reach < layout.width && y + reach < layout.height;
    return inside ? mean_inside(x, y, whole, rest) : mean_near_border(x, y, radius);
  }

 private:
  /// A square of fractional radius is a mixture of four boxes that are k or k + 1 wide and high.
  [[nodiscard]] RELUMBRE_HOST_DEVICE SatSums mean_inside(std::size_t x, std::size_t y,
                                                         std::size_t k, double f) const {
    SatSums total{};
    const auto add = [&](std::size_t h, std::size_t v, double weight) {
      reader_.add(x - h, y - v, x + h + 1, y + v + 1, weight, total);
    };
    add(k, k, (1 - f) * (1 - f));
    if (f > 0) add(k + 1, k, f * (1 - f)), add(k, k + 1, f * (1 - f)), add(k + 1, k + 1, f * f);
    const double side = 2 * (static_cast<double>(k) + f) + 1;
    for (double& t : total) t /= side * side;
    return total;
  }

  [[nodiscard]] RELUMBRE_HOST_DEVICE SatSums mean_near_border(std::size_t x, std::size_t y,
                                                              double radius) const {
    const auto window = [&](std::size_t at, std::size_t size) {
      const auto centre = static_cast<double>(at);
      return AxisWindow(centre - radius, centre + radius + 1, size, border_.mode);
    };
    const SatLayout& layout = reader_.layout();
    return reader_.mean(window(x, layout.width), window(y, layout.height), border_);
  }

  const Reader& reader_;
  const BorderRule& border_;
};

}  // namespace relumbre
