/// Fixed point for summed-area tables: fine enough for the values, coarse enough for the boxes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "relumbre/base/host_device.h"

namespace relumbre {

/// The values of an image lie in [lowest, highest].
struct SatRange {
  double lowest = 0, highest = 0;
};

/// A value v is stored as the integer round(v · scale), half to even. Sums of these wrap around
/// modulo 2^bits, and so may the whole table, many times; a box sum is recovered exactly from the
/// wrapped one, because it lies in an interval less than 2^bits long:
///
///   N · lowest_unit ≤ Σ over N pixels ≤ N · highest_unit,   N (highest_unit − lowest_unit) <
///   2^bits
struct FixedPoint {
  double scale = 1;  ///< a power of two, so that scaling itself never rounds
  std::int64_t lowest_unit = 0;
  std::size_t largest_box = 0;  ///< pixels of which the sum is certain to fit

  [[nodiscard]] RELUMBRE_HOST_DEVICE double unit() const { return 1 / scale; }
  /// The sum of `pixels` values from what four wrapped sums differ by.
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::int64_t unwrap(std::uint32_t wrapped,
                                                         std::size_t pixels) const {
    const std::uint64_t least = pixels * static_cast<std::uint64_t>(lowest_unit);
    const std::uint32_t above_least = wrapped - static_cast<std::uint32_t>(least);
    return static_cast<std::int64_t>(least + above_least);
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::int64_t unwrap(std::uint64_t wrapped, std::size_t) const {
    return static_cast<std::int64_t>(wrapped);
  }
};

/// The finest scale at which boxes of `largest_box` pixels fit, and below 2^30 units (32 bits) or
/// 2^50 (64 bits) a value. Throws ValueError: a range that is not finite or not ordered, or of
/// which 32 bits cannot tell lowest from highest in a box so large.
FixedPoint fixed_point_for_reals(const SatRange& range, std::size_t largest_box, int bits);

/// Integers as they are. `largest_box` 0: as many of `pixels` as fit. Throws ValueError if a larger
/// box is asked than fits.
FixedPoint fixed_point_for_integers(const SatRange& range, std::size_t largest_box,
                                    std::size_t pixels, int bits);

}  // namespace relumbre
