#include "relumbre/sat/fixed_point.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

void check(const SatRange& range) {
  if (std::isfinite(range.lowest) && std::isfinite(range.highest) && range.lowest <= range.highest)
    return;
  throw ValueError(fmt::format("summed-area table: values from {} to {} are no finite range",
                               range.lowest, range.highest));
}

[[noreturn]] void refuse_box(std::size_t pixels, int bits, const SatRange& range) {
  throw ValueError(
      fmt::format("summed-area table: a box of {} pixels of values from {} to {} does not fit into "
                  "{} bits",
                  pixels, range.lowest, range.highest, bits));
}

/// How far apart sums may be.
double room(int bits) { return bits == 32 ? 4294967295.0 : std::ldexp(1, 62); }

}  // namespace

FixedPoint fixed_point_for_reals(const SatRange& range, std::size_t largest_box, int bits) {
  check(range);
  const double pixels = static_cast<double>(std::max<std::size_t>(largest_box, 1));
  const double largest = std::max(std::abs(range.lowest), std::abs(range.highest));
  // 64 bits are read as signed sums, so there it is the values that count and not how far apart.
  const double spread = bits == 32 ? range.highest - range.lowest : largest;
  const double levels = room(bits) / pixels - 1;  // rounding may add a unit
  if (!(levels >= 1)) refuse_box(largest_box, bits, range);
  double scale = std::ldexp(1, 120);
  if (largest > 0) scale = std::min(scale, std::ldexp(1, bits == 32 ? 30 : 50) / largest);
  if (spread > 0) scale = std::min(scale, levels / spread);
  FixedPoint fixed;
  fixed.scale = largest > 0 ? std::ldexp(1, std::ilogb(scale)) : 1;
  fixed.lowest_unit = static_cast<std::int64_t>(std::nearbyint(range.lowest * fixed.scale));
  fixed.largest_box = static_cast<std::size_t>(pixels);
  return fixed;
}

FixedPoint fixed_point_for_integers(const SatRange& range, std::size_t largest_box,
                                    std::size_t pixels, int bits) {
  check(range);
  const double spread = bits == 32 ? range.highest - range.lowest : range.highest;
  const double fitting = std::min(std::floor(room(bits) / std::max(spread, 1.0)), 1e15);
  if (largest_box > 0 && static_cast<double>(largest_box) > fitting)
    refuse_box(largest_box, bits, range);
  const std::size_t box =
      largest_box > 0 ? largest_box : std::min(pixels, static_cast<std::size_t>(fitting));
  return {1, static_cast<std::int64_t>(range.lowest), box};
}

}  // namespace relumbre
