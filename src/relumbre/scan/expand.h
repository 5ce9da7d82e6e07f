/// Allocation by scan: from how much each one needs to where it begins, and from there to who owns
/// what.
///
///   counts   [2 0 3]   →   offsets [0 2 2 5]   →   owners [0 0 2 2 2]
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan.h"

namespace relumbre {

/// a + b, or the largest number where that is larger still.
struct SaturatingPlus {
  using value_type = std::uint64_t;
  static constexpr bool exact = true;
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr std::uint64_t identity() const { return 0; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr std::uint64_t operator()(std::uint64_t a,
                                                                        std::uint64_t b) const {
    return a + b < a ? std::numeric_limits<std::uint64_t>::max() : a + b;
  }
};

/// offsets[i] = counts[0] + ... + counts[i-1], for i up to and including n: `offsets` has one
/// element more than `counts` (ShapeError) and does not overlap it. Returns the total, offsets[n].
/// Throws ValueError where the total is too large for an offset; `offsets` is then of no use.
template <Array Counts, Array Offsets>
requires std::unsigned_integral<std::ranges::range_value_t<Counts>> &&
    std::unsigned_integral<std::ranges::range_value_t<Offsets>>
        std::uint64_t offsets_from_counts(const Counts& counts, Offsets&& offsets) {
  using Offset = std::ranges::range_value_t<Offsets>;
  const auto needs = scan_detail::input(counts);
  const auto begins = scan_detail::output(offsets);
  check::same_size("offsets_from_counts", "offsets", begins.size(), needs.size() + 1);
  check::disjoint("offsets_from_counts", needs, scan_detail::input(offsets));
  const std::uint64_t total = exclusive_scan(needs, begins.first(needs.size()), SaturatingPlus());
  // The largest 64-bit number stands for all that are larger.
  if (total > std::numeric_limits<Offset>::max() ||
      total == std::numeric_limits<std::uint64_t>::max())
    throw ValueError("offsets_from_counts: the total does not fit an offset of " +
                     std::to_string(sizeof(Offset)) + " bytes");
  begins.back() = static_cast<Offset>(total);
  return total;
}

/// owners[j] = the i with offsets[i] ≤ j < offsets[i+1], for all j < offsets[n].
/// Throws ShapeError unless `owners` has offsets[n] elements, ValueError unless offsets begin with
/// 0 and never decrease, or where an index is too large for an owner. Work is spread evenly however
/// uneven the counts are.
template <Array Offsets, Array Owners>
requires std::unsigned_integral<std::ranges::range_value_t<Offsets>> &&
    std::unsigned_integral<std::ranges::range_value_t<Owners>>
void expand(const Offsets& offsets, Owners&& owners) {
  using Owner = std::ranges::range_value_t<Owners>;
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  const auto begins = scan_detail::input(offsets);
  const auto to = scan_detail::output(owners);
  if (begins.empty() || begins.front() != 0 || !std::ranges::is_sorted(begins))
    throw ValueError("expand: offsets must begin with 0 and never decrease");
  check::same_size("expand", "owners", to.size(), begins.back());
  check::disjoint("expand", begins, scan_detail::input(owners));
  if (begins.size() - 1 > std::numeric_limits<Owner>::max())
    throw ValueError("expand: " + std::to_string(begins.size() - 1) + " owners do not fit " +
                     std::to_string(sizeof(Owner)) + " bytes");
  parallel_chunks(0, to.size(), kGrain, [&](std::size_t first, std::size_t last) {
    const auto behind = std::ranges::upper_bound(begins, first);
    auto owner = static_cast<std::size_t>(behind - begins.begin()) - 1;
    for (std::size_t j = first; j < last; ++j) {
      while (begins[owner + 1] <= j) ++owner;
      to[j] = static_cast<Owner>(owner);
    }
  });
}

}  // namespace relumbre
