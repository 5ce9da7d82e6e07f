/// Builds the bare table of sums, for those who bring their own queries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "relumbre/sat/sat_layout.h"

namespace relumbre {

/// What is summed instead of the pixels' values themselves.
template <class In>
struct SatSummands {
  /// Real values in unsigned tables: round(value · scale), half to even. A power of two.
  double scale = 1;
  /// float32 tables: what is taken from every value of each channel.
  std::array<float, kSatMaxChannels> mean{};
  /// Unsigned tables: values that lie outside, and NaN, are refused. |value · scale| must be below
  /// 2^31 (32 bits) or 2^51 within.
  In lowest = std::numeric_limits<In>::lowest(), highest = std::numeric_limits<In>::max();
};

/// Fills `table` (layout.elements numbers whose first begins a cache line), row 0 and column 0
/// included, with
///
///   t(x, y) = Σ over i < x, j < y of summand(i, j)
///
/// of `pixels`, interleaved and row-major. Sums of unsigned type wrap around, so that differences
/// of four of them are exact for every box whose own sum fits. In one pass over memory: each pixel
/// is read once and each sum written once, past the caches where the table outgrows them.
///
/// The image is cut into column strips. A strip goes down row by row beside the one to its left,
/// from which it takes each row's sum so far; so threads work on as many strips at a time. Each sum
/// is made by the same additions in the same order whatever the number of threads and the
/// instruction set: also float tables have the same bits always. An image of up to 128
/// columns is one strip and so one thread's work.
///
/// In: float, uint8, uint16, uint32. T: uint32, uint64, float, double. Returns false if a value of
/// an unsigned table is out of range; the table is then of no use. What is not finite goes into
/// float tables as it is. Throws ShapeError if a size disagrees. Cost: sizeof(In) + sizeof(T) bytes
/// a value; memory besides: the last row of each strip in work, and a column of sums.
///
/// Source: Crow 1984; the carry between blocks as in Nehab et al. 2011, there between tiles.
template <class In, class T>
[[nodiscard]] bool build_sat_table(std::span<const In> pixels, const SatLayout& layout,
                                   const SatSummands<In>& summands, std::span<T> table);

}  // namespace relumbre
