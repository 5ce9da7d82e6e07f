/// Prefix sums over any monoid: sequential, vectorised, threaded.
///
///   inclusive   out[i] = in[0] ∘ in[1] ∘ ... ∘ in[i]
///   exclusive   out[i] = e ∘ in[0] ∘ ... ∘ in[i-1], so [3 1 7 0 4 1 6 3] → [0 3 4 11 11 15 16 22]
///
/// `in` and `out` are vectors, arrays or spans of equal size. Elements are converted to the
/// monoid's value_type, accumulated in it, and each result is converted to the element type of
/// `out`: sums of bytes do not narrow where the monoid is Plus<std::uint64_t>. Both functions
/// return the fold of all elements, which for an inclusive scan is the last result.
///
/// Memory: `out` may be the same array as `in`, of elements of the same size; any other overlap is
/// refused. One pass: every element is read from memory once and written once. Arrays that outgrow
/// the caches are written past them.
///
/// Results have the same bits whatever the number of threads: tiles depend on the size and types
/// only, and prefixes are folded in their order. Floating-point sums depend on the instruction set
/// (see kernels.h), and are not monotone in the last bit.
///
/// Precision: without a monoid, sums of float32 into float32 are within
/// 8·2⁻²⁴·Σ|x| + 2⁻²³·|result| of the true ones, however long the array. So is Plus<float>;
/// Plus<double> accumulates all in float64 and rounds once, at 40% of the speed in cache.
///
/// Vectorised: see kKernel in kernels.h. All else is scanned element by element.
///
/// Throws ShapeError where sizes differ, ValueError where arrays overlap in part. What the monoid
/// throws is passed on; `out` then holds nothing of use. The operation is called by several threads
/// at once, and must not itself run a parallel loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <ranges>
#include <span>
#include <type_traits>
#include <utility>

#include "relumbre/scan/chained.h"
#include "relumbre/scan/check.h"
#include "relumbre/scan/kernel_work.h"
#include "relumbre/scan/kernels.h"
#include "relumbre/scan/monoid.h"
#include "relumbre/scan/scan_kind.h"
#include "relumbre/scan/sequential.h"

namespace relumbre {

namespace scan_detail {

/// Element by element: load(i) gives a value, store(i, value) takes a result.
template <ScanKind kKind, Monoid M, class Load, class Store>
class ElementWork {
 public:
  static constexpr bool kOnePass = kIsExact<M>;
  static constexpr std::size_t kWorthThreads = 2, kGroup = 1;
  using Value = typename M::value_type;

  ElementWork(const M& m, const Load& load, const Store& store)
      : m_(m), load_(load), store_(store) {}

  [[nodiscard]] Value identity() const { return m_.identity(); }
  [[nodiscard]] Value combine(const Value& a, const Value& b) const { return m_(a, b); }
  [[nodiscard]] Value fold(std::size_t first, std::size_t last) const {
    return sequential::fold(first, last, m_.identity(), m_, load_);
  }
  Value scan(std::size_t first, std::size_t last, Value prefix) const {
    if constexpr (kKind == ScanKind::kInclusive)
      return sequential::inclusive(first, last, std::move(prefix), m_, load_, store_);
    else
      return sequential::exclusive(first, last, std::move(prefix), m_, load_, store_);
  }

 private:
  const M& m_;
  const Load& load_;
  const Store& store_;
};

/// A scan of anything that can be loaded and stored by its index.
template <ScanKind kKind, Monoid M, class Load, class Store>
typename M::value_type scan_elements(std::size_t size, std::size_t tile, const M& m,
                                     const Load& load, const Store& store) {
  ElementWork<kKind, M, Load, Store> work(m, load, store);
  return chained::scan_tiles({size, tile}, false, work);
}

template <ScanKind kKind, class In, class Out, Monoid M>
typename M::value_type scan(const char* function, std::span<const In> in, std::span<Out> out,
                            const M& m) {
  using Value = typename M::value_type;
  check::same_size(function, "output", out.size(), in.size());
  check::in_place_or_disjoint(function, in, std::span<const Out>(out));
  if constexpr (!std::is_null_pointer_v<std::remove_cv_t<decltype(kKernel<In, M, Out>)>>) {
    return static_cast<Value>(scan_by_kernel<kKind, In, M, Out>(in, out));
  } else {
    return scan_elements<kKind>(
        in.size(), kTile<In>, m, [in](std::size_t i) { return static_cast<Value>(in[i]); },
        [out](std::size_t i, const Value& value) { out[i] = static_cast<Out>(value); });
  }
}

template <Array A>
auto input(const A& a) {
  return std::span<const std::ranges::range_value_t<A>>(a);
}
template <Array A>
auto output(A& a) {
  return std::span<std::ranges::range_value_t<A>>(a);
}

}  // namespace scan_detail

template <ScanKind kKind>
struct ScanFunction {
  const char* name;
  template <Array In, Array Out,
            Monoid M = DefaultPlus<std::ranges::range_value_t<In>, std::ranges::range_value_t<Out>>>
  typename M::value_type operator()(const In& in, Out&& out, const M& m = {}) const {
    return scan_detail::scan<kKind>(name, scan_detail::input(in), scan_detail::output(out), m);
  }
};

// Objects, not functions: else a call with vectors would find the standard library's as well.

/// inclusive_scan(in, out, monoid): out[i] = in[0] ∘ ... ∘ in[i]. Returns the fold of all.
inline constexpr ScanFunction<ScanKind::kInclusive> inclusive_scan{"inclusive_scan"};

/// exclusive_scan(in, out, monoid): out[i] = in[0] ∘ ... ∘ in[i-1], the identity at 0. Returns the
/// fold of all.
inline constexpr ScanFunction<ScanKind::kExclusive> exclusive_scan{"exclusive_scan"};

}  // namespace relumbre
