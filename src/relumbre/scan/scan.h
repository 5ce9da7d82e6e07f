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
#include "relumbre/scan/kernels.h"
#include "relumbre/scan/monoid.h"
#include "relumbre/scan/sequential.h"
#include "relumbre/scan/stream_writer.h"

namespace relumbre {

enum class ScanKind { kInclusive, kExclusive };

/// What sums In into Out without loss: never narrower than Out, and wider for float32.
template <class In, class Out>
using DefaultPlus =
    Plus<std::conditional_t<std::is_same_v<Out, float> && !std::is_same_v<In, float>, double, Out>>;

namespace scan_detail {

/// Tiles fit the second-level cache beside what else is there.
inline constexpr std::size_t kTileBytes = std::size_t{64} << 10;

/// A whole number of granules.
template <class In>
inline constexpr std::size_t kTile =
    std::max<std::size_t>(kTileBytes / sizeof(In) / kRunGranule, 1) * kRunGranule;

/// Where a tile takes a microsecond, threads meet at shorter ones.
template <class In>
inline constexpr std::size_t kKernelTile = kTile<In> / 4;

/// Vectorised.
template <ScanKind kKind, class In, class M, class Out>
class KernelWork {
 public:
  static constexpr bool kOnePass = true;
  static constexpr std::size_t kWorthThreads = 16, kGroup = 4;
  static constexpr auto kMember = kKernel<In, M, Out>;
  using Kernel = std::remove_cvref_t<decltype(std::declval<ScanKernels>().*kMember)>;
  using Value = typename Kernel::carry_type;
  using Combine =
      std::conditional_t<std::is_same_v<M, Plus<typename M::value_type>>, Plus<Value>, M>;

  KernelWork(std::span<const In> in, std::span<Out> out, const M&)
      : kernel_(best_scan_kernels().*kMember),
        in_(in.data()),
        size_(in.size()),
        out_(out.data()),
        in_place_(static_cast<const void*>(in_) == static_cast<const void*>(out_)),
        outgrows_(outgrows_cache(in.size_bytes() + (in_place_ ? 0 : out.size_bytes()))) {}

  [[nodiscard]] bool in_parts() const { return !in_place_ && !outgrows_; }

  [[nodiscard]] Value identity() const { return Combine().identity(); }
  [[nodiscard]] Value combine(Value a, Value b) const { return Combine()(a, b); }
  [[nodiscard]] Value fold(std::size_t first, std::size_t last) const {
    return kernel_.fold(in_ + first, last - first, identity());
  }
  Value scan(std::size_t first, std::size_t last, Value prefix) const {
    return scan(first, last, prefix, size_);
  }
  Value scan(std::size_t first, std::size_t last, Value prefix, std::size_t ahead) const {
    if (!outgrows_) return combine(prefix, run(first, last, out_ + first, prefix, identity()));
    if (in_place_) return combine(prefix, scan_in_place(first, last, prefix, ahead));
    return combine(prefix, stream(first, last, prefix, ahead));
  }
  void end_thread() const {
    if (outgrows_) end_streaming();
  }

 private:
  Value run(std::size_t first, std::size_t last, Out* to, Value prefix, Value local) const {
    const auto scan = kKind == ScanKind::kInclusive ? kernel_.inclusive : kernel_.exclusive;
    return scan(in_ + first, last - first, to, prefix, local);
  }
  Value scan_in_place(std::size_t first, std::size_t last, Value prefix, std::size_t ahead) const {
    Value local = identity();
    for (std::size_t i = first; i < last; i += kRun, ahead += kRun) {
      fetch(ahead);
      local = run(i, std::min(i + kRun, last), out_ + i, prefix, local);
    }
    return local;
  }
  Value stream(std::size_t first, std::size_t last, Value prefix, std::size_t ahead) const {
    StreamWriter<Out> writer(out_ + first);
    Value local = identity();
    for (std::size_t i = first; i < last; i += kRun, ahead += kRun) {
      const std::size_t end = std::min(i + kRun, last);
      fetch(ahead);
      local = run(i, end, writer.buffer(), prefix, local);
      writer.commit(end - i);
    }
    writer.finish();
    return local;
  }

  static constexpr std::size_t kRun = StreamWriter<Out>::kRun;

  /// Asks for the run at `first`.
  [[gnu::always_inline]] void fetch(std::size_t first) const {
    constexpr std::size_t kLine = 64 / sizeof(In);
    const std::size_t last = std::min(size_, first + kRun);
    for (std::size_t i = first; i < last; i += kLine) __builtin_prefetch(in_ + i, 0, 2);
  }

  const Kernel& kernel_;
  const In* in_;
  std::size_t size_;
  Out* out_;
  bool in_place_, outgrows_;
};

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
    KernelWork<kKind, In, M, Out> work(in, out, m);
    return static_cast<Value>(
        chained::scan_tiles({in.size(), kKernelTile<In>}, work.in_parts(), work));
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
