/// Internal: what is summed up when blurs are spread, and how a blur is tilted.
#pragma once

#include <algorithm>
#include <cmath>

#include "relumbre/base/host_device.h"
#include "relumbre/dof/fragment.h"

namespace relumbre {

/// Colour and weight of a pixel of a layer. Doubles: steps up and down have to cancel beside
/// highlights that are a million times as bright.
template <int kLanes>
struct LaneSum {
  double lane[kLanes] = {};

  void add(const LaneSum& other, double scale) {
    for (int i = 0; i < kLanes; ++i) lane[i] += other.lane[i] * scale;
  }
  void add(const LaneSum& other) {
    for (int i = 0; i < kLanes; ++i) lane[i] += other.lane[i];
  }
};

/// Of pictures whose alpha is 1 wherever there is something.
struct OpaqueSum : LaneSum<4> {
  OpaqueSum() = default;
  OpaqueSum(const Rgba& c, double coverage, double share)
      : LaneSum{{c.r * share, c.g * share, c.b * share, coverage * share}} {}
  [[nodiscard]] double weight() const { return lane[3]; }
  [[nodiscard]] Rgba color() const {
    return {static_cast<float>(lane[0]), static_cast<float>(lane[1]), static_cast<float>(lane[2]),
            static_cast<float>(lane[3])};
  }
};

struct AlphaSum : LaneSum<5> {
  AlphaSum() = default;
  AlphaSum(const Rgba& c, double coverage, double share)
      : LaneSum{{c.r * share, c.g * share, c.b * share, c.a * share, coverage * share}} {}
  [[nodiscard]] double weight() const { return lane[4]; }
  [[nodiscard]] Rgba color() const {
    return {static_cast<float>(lane[0]), static_cast<float>(lane[1]), static_cast<float>(lane[2]),
            static_cast<float>(lane[3])};
  }
};

/// How a blur's brightness changes across it: 1 + x · right + y · down at offset (x, y) from its
/// centre.
struct Tilt {
  double right = 0, down = 0;
};

/// Points of a slanted surface are blurred the more the farther along the slope they are. What
/// lands on a pixel from them is, per area of the surface in the picture,
///
///   (1 + ⟨x − p, ∇c⟩ / c) / area(c)      p: the point's pixel, x: the pixel it lands on
///
/// which is the Jacobian of the lens point 2 (x − p) / c(p) that looks from x at p; without it,
/// the blurs on a floor would not add up to 1.
/// `reach`: columns and rows to either side that the blur touches.
RELUMBRE_HOST_DEVICE inline Tilt tilt_of(const Fragment& fragment, double reach) {
  constexpr double kLargest = 0.9;  // beyond, the surface is seen edge-on
  const double c = static_cast<double>(fragment.coc);
  if (std::abs(c) < 1) return {};
  const Tilt tilt{static_cast<double>(fragment.slope.x) / c,
                  static_cast<double>(fragment.slope.y) / c};
  const double steepest = std::hypot(tilt.right, tilt.down) * reach;
  const double scale = steepest > kLargest ? kLargest / steepest : 1;
  return {tilt.right * scale, tilt.down * scale};
}

/// A coordinate and those of its repetitions beyond the border, where the picture goes on as it
/// ends: as far as a blur reaches.
struct Repeats {
  int first, last;
};
RELUMBRE_HOST_DEVICE inline Repeats repeats(std::uint32_t coordinate, int size, int before,
                                            int after) {
  const int at = static_cast<int>(coordinate);
  return {at == 0 ? -before : at, at == size - 1 ? at + after : at};
}

}  // namespace relumbre
