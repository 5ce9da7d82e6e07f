/// Builds the bare table of sums on a GPU: the twin of sat_table.h.
#pragma once

#include <cstdint>

#include "relumbre/cuda/stream.h"
#include "relumbre/sat/sat_summands.h"
#include "relumbre/scan/scan_scratch_cuda.h"

namespace relumbre::cuda {

/// Fills `table` (layout.elements numbers in device memory, from an address that is a multiple of
/// 64), row 0 and column 0 included, with
///
///   t(x, y) = Σ over i < x, j < y of summand(i, j)
///
/// of `pixels` (width · height · channels values in device memory), interleaved and row-major. The
/// work is asked for in the stream, and can be recorded in a Graph if the scratch has been used for
/// a table as large. If `first_outside` (in device memory) is larger than the index of a value that
/// an unsigned table refuses, it becomes that of the first such value; the table is then of no use.
///
/// Unsigned sums wrap around and have the bits of build_sat_table(). Sums of float and double are
/// the same in every run too, but added in another order than the CPU's: differences are within
/// (1 + height / 32 + width / 32) · 2⁻²³ (2⁻⁵² in double) of the sum of absolute values.
///
/// In: float, uint8, uint16, uint32. T: uint32, uint64, float, double. In one pass over memory; see
/// sat_tiles_cuda.cuh. Besides, up to a tenth of the table's size of scratch.
template <class In, class T>
void build_sat_table(const In* pixels, const SatLayout& layout, const SatSummands<In>& summands,
                     T* table, unsigned long long* first_outside, ScanScratch& scratch,
                     const Stream& stream);

}  // namespace relumbre::cuda
