/// Prefix sums over any monoid on a GPU: the twins of scan.h.
///
///   inclusive   out[i] = in[0] ∘ in[1] ∘ ... ∘ in[i]
///   exclusive   out[i] = e ∘ in[0] ∘ ... ∘ in[i-1]
///
/// All pointers are to device memory. Elements are converted to the monoid's value_type (trivially
/// copyable, of any size), folded in it, and each result is converted to the element type of `out`.
/// `total`, if it is given, gets the fold of all elements, the identity if there are none. The work
/// is asked for in the stream and can be recorded in a Graph (see ScanScratch).
///
/// Memory: `out` may be `in`, of elements of the same size; any other overlap is not allowed. One
/// pass: every element is read once and written once, by accesses of 16 bytes where both arrays
/// begin at multiples of 16 (else up to 4 times as many accesses). Besides, 8 bytes a tile for
/// each 4 of a value.
///
/// Results have the same bits in every run: the order of all operations depends on the size and the
/// types only, never on timing (look_back_cuda.cuh). Those of exact monoids (integers, Min, Max)
/// are the CPU's. Floating-point sums differ from the CPU's within rounding: without a monoid, or
/// with Plus<float>, float32 results are within (40 + size / 2^18) · 2⁻²⁴ · Σ|x| of the true ones;
/// Plus<double> folds in float64 and rounds once, and needs little more time.
///
/// Source: Merrill and Garland 2016, "Single-pass parallel prefix scan with decoupled look-back".
#pragma once

#include "relumbre/scan/scan_tiles_cuda.cuh"

namespace relumbre::cuda {

template <class In, class Out, Monoid M = DefaultPlus<In, Out>>
void inclusive_scan(const In* in, std::size_t size, Out* out, ScanScratch& scratch,
                    const Stream& stream, const M& m = {},
                    typename M::value_type* total = nullptr) {
  scan_detail::scan<ScanKind::kInclusive>(scan_detail::Arrays<In, Out, M>(in, out), size, m,
                                          scratch, stream, total);
}

template <class In, class Out, Monoid M = DefaultPlus<In, Out>>
void exclusive_scan(const In* in, std::size_t size, Out* out, ScanScratch& scratch,
                    const Stream& stream, const M& m = {},
                    typename M::value_type* total = nullptr) {
  scan_detail::scan<ScanKind::kExclusive>(scan_detail::Arrays<In, Out, M>(in, out), size, m,
                                          scratch, stream, total);
}

}  // namespace relumbre::cuda
