/// Builds the bare table of sums, for those who bring their own queries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "relumbre/sat/sat_summands.h"

namespace relumbre {

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
