/// The inner loops of the common scans, compiled once per instruction set.
///
/// A kernel works on a run of one tile. `prefix` is the fold of all tiles before, `local` that of
/// the tile's elements before the run; every kernel returns `local` extended by the run. A tile may
/// be cut into runs at multiples of kRunGranule without a change in any bit. scan's output has the
/// bits of prefix ∘ (local ∘ ...). fold returns the same bits as the scans; quick_fold folds whole
/// tiles in an order of its own, in less than half of fold's time where order matters to the bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "relumbre/scan/monoid.h"

namespace relumbre {

inline constexpr std::size_t kRunGranule = 128;

template <class In, class Carry, class Out>
struct ScanKernel {
  using carry_type = Carry;
  Carry (*fold)(const In* in, std::size_t count, Carry local);
  Carry (*quick_fold)(const In* in, std::size_t count);
  /// `out` may be `in`.
  Carry (*inclusive)(const In* in, std::size_t count, Out* out, Carry prefix, Carry local);
  Carry (*exclusive)(const In* in, std::size_t count, Out* out, Carry prefix, Carry local);
};

template <class T>
using PlainKernel = ScanKernel<T, T, T>;

/// One instruction set's kernels.
struct ScanKernels {
  std::string_view name;
  /// Sums of short blocks in float32, all that is longer in float64: every result is within
  /// 8·2⁻²⁴·Σ|x| + 2⁻²³·|result| of the true sum, however long the array.
  ScanKernel<float, double, float> plus_float;
  /// All in float64.
  ScanKernel<float, double, float> plus_double_of_float;
  ScanKernel<float, double, double> plus_float_to_double;
  PlainKernel<double> plus_double;
  PlainKernel<std::int32_t> plus_int32;
  PlainKernel<std::uint32_t> plus_uint32;
  PlainKernel<std::int64_t> plus_int64;
  PlainKernel<std::uint64_t> plus_uint64;
  PlainKernel<float> min_float, max_float;
  PlainKernel<double> min_double, max_double;
  PlainKernel<std::int32_t> min_int32, max_int32;
  PlainKernel<std::uint32_t> min_uint32, max_uint32;
};

/// The kernels for the best instruction set that this CPU has.
const ScanKernels& best_scan_kernels();

/// Every set of kernels that this CPU can run, best first, for tests. Not thread-safe.
std::vector<ScanKernels> available_scan_kernels();

/// Which kernel, if any, scans elements In by M into Out.
template <class In, class M, class Out>
inline constexpr std::nullptr_t kKernel = nullptr;
template <>
inline constexpr auto kKernel<float, Plus<float>, float> = &ScanKernels::plus_float;
template <>
inline constexpr auto kKernel<float, Plus<double>, float> = &ScanKernels::plus_double_of_float;
template <>
inline constexpr auto kKernel<float, Plus<double>, double> = &ScanKernels::plus_float_to_double;
template <>
inline constexpr auto kKernel<double, Plus<double>, double> = &ScanKernels::plus_double;
template <>
inline constexpr auto kKernel<std::int32_t, Plus<std::int32_t>, std::int32_t> =
    &ScanKernels::plus_int32;
template <>
inline constexpr auto kKernel<std::int64_t, Plus<std::int64_t>, std::int64_t> =
    &ScanKernels::plus_int64;
template <>
inline constexpr auto kKernel<std::uint32_t, Plus<std::uint32_t>, std::uint32_t> =
    &ScanKernels::plus_uint32;
template <>
inline constexpr auto kKernel<std::uint64_t, Plus<std::uint64_t>, std::uint64_t> =
    &ScanKernels::plus_uint64;
template <>
inline constexpr auto kKernel<float, Min<float>, float> = &ScanKernels::min_float;
template <>
inline constexpr auto kKernel<float, Max<float>, float> = &ScanKernels::max_float;
template <>
inline constexpr auto kKernel<double, Min<double>, double> = &ScanKernels::min_double;
template <>
inline constexpr auto kKernel<double, Max<double>, double> = &ScanKernels::max_double;
template <>
inline constexpr auto kKernel<std::int32_t, Min<std::int32_t>, std::int32_t> =
    &ScanKernels::min_int32;
template <>
inline constexpr auto kKernel<std::int32_t, Max<std::int32_t>, std::int32_t> =
    &ScanKernels::max_int32;
template <>
inline constexpr auto kKernel<std::uint32_t, Min<std::uint32_t>, std::uint32_t> =
    &ScanKernels::min_uint32;
template <>
inline constexpr auto kKernel<std::uint32_t, Max<std::uint32_t>, std::uint32_t> =
    &ScanKernels::max_uint32;

}  // namespace relumbre
