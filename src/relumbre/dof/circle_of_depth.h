/// Internal: the circle of confusion of a depth, for the CPU and the GPU.
#pragma once

#include <algorithm>
#include <cstddef>

#include "relumbre/base/host_device.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

/// ThinLens::signed_coc_diameter_pixels with a limit, of a picture of one width.
class CircleOfDepth {
 public:
  CircleOfDepth(const ThinLens& lens, std::size_t width, double largest)
      : at_infinity_(lens.coc_at_infinity_pixels(width)),
        focus_(lens.focus_distance_m),
        largest_(largest) {}

  /// Signed diameter, pixels; 0 of a depth of 0, which is not known.
  [[nodiscard]] RELUMBRE_HOST_DEVICE float operator()(float depth) const {
    if (depth == 0) return 0;
    const double coc = at_infinity_ * (1 - focus_ / static_cast<double>(depth));
    return static_cast<float>(std::clamp(coc, -largest_, largest_));
  }

 private:
  double at_infinity_, focus_, largest_;
};

}  // namespace relumbre
