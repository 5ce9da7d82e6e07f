/// The blur of one point as rows of pixels.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/base/host_device.h"
#include "relumbre/dof/outline.h"

namespace relumbre {

/// How a pixel's light is shared out among those around it: by the area that the blur, an outline
/// of diameter c around the pixel's centre, covers of each row; within a row from left to right
/// without a gap. A blur that stays inside its pixel leaves the picture untouched.
///
///      top ─►   ┌──┐            rows[j]: [left, right) from the centre, in pixels, the outline's
///             ┌─┘  └─┐                   mean width in row top + j, and the fraction `height` of
///             └─┐  ┌─┘                   the row that it reaches into
///               └──┘            Σ_j height · (right − left) = area = 1 / share
struct ApertureKernel {
  /// A span of a row as four steps of the running sum over x: `+(1 − f)` and `+f` at two
  /// neighbouring pixels where it begins, and the same with − where it ends.
  struct Span {
    int begin = 0, end = 0;                      ///< pixels from the centre
    float begin_fraction = 0, end_fraction = 0;  ///< f
    float height = 1;
  };
  int top = 0;
  int reach = 0;     ///< columns to either side that are touched
  double share = 1;  ///< of the light, of a fully covered pixel
  std::vector<Span> rows;

  [[nodiscard]] int bottom() const { return top + static_cast<int>(rows.size()); }
};

namespace kernel_steps {
// A pixel's own share of its light falls by half from a blur of 1 to one of 1.6 pixels: steps
// there must be fine, or rings of neighbouring steps show.
inline constexpr double kStepsPerPixel = 64, kEvenUpTo = 4;
inline constexpr int kDroppedBits =
    15;  // of a float's mantissa of 23: 256 steps an octave are left

/// Where steps cease to be even, as the number that is left of a float's bits.
inline constexpr std::uint32_t kEven = std::bit_cast<std::uint32_t>(4.0F) >> kDroppedBits;
inline constexpr std::uint32_t kEvenSteps = 256;
}  // namespace kernel_steps

/// Which of the diameters that have kernels is the nearest; see ApertureKernels.
RELUMBRE_HOST_DEVICE inline std::uint32_t kernel_step(double diameter) {
  using namespace kernel_steps;
  if (diameter <= kEvenUpTo) return static_cast<std::uint32_t>(kStepsPerPixel * diameter + 0.5);
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(diameter));
  return kEvenSteps + ((bits + (1U << (kDroppedBits - 1))) >> kDroppedBits) - kEven;
}

/// Kernels of all diameters up to a largest: in steps of 1/64 pixel up to 4 pixels, of 256
/// an octave beyond.
class ApertureKernels {
 public:
  /// Kernels of both signs. Throws ValueError for a largest diameter that is not finite or above
  /// kLargest.
  ApertureKernels(BlurShape shape, const Aperture& aperture, double largest_diameter);

  /// Behind the plane in focus (`signed_diameter` > 0), or before it: turned by half a turn.
  [[nodiscard]] const ApertureKernel& of(double signed_diameter) const;

  /// All of one sign, ascending: of() takes the one at kernel_step(), or the last.
  [[nodiscard]] const std::vector<ApertureKernel>& all(bool before) const {
    return before ? before_ : behind_;
  }

  static constexpr double kLargest = 2048;

 private:
  std::vector<ApertureKernel> behind_, before_;  // by step
};

}  // namespace relumbre
