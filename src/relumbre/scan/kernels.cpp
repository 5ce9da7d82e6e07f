#include "relumbre/scan/kernels.h"

#include <cmath>
#include <iterator>
#include <numeric>

// Arrays of vectors need vectors of a known size.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relumbre/scan/kernels.cpp"
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on
#include "relumbre/scan/strips-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

// Vectors of one lane have no blocks: everything is left to the loops over single elements.
template <class>
struct PlusLanes {};
template <class>
struct ExtremeLanes {};
template <class, class M>
struct LaneCarry {
  using monoid = M;
};
struct WideCarry {
  using monoid = Plus<double>;
};
template <class Op, class CarryState, class In, class Out>
struct Blocks {
  using Carry = typename CarryState::monoid::value_type;
  template <bool>
  static std::size_t scan(const In*, std::size_t, Out*, Carry, Carry&) {
    return 0;
  }
  static std::size_t fold(const In*, std::size_t, Carry&) { return 0; }
  static std::size_t quick_fold(const In*, std::size_t, Carry&) { return 0; }
};

#else

template <class T>
struct PlusLanes {
  using Lane = T;
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;
  static HWY_INLINE V apply(V a, V b) { return hn::Add(a, b); }
  static HWY_INLINE V clean(V v) { return v; }
  static HWY_INLINE V select(hn::Mask<D> mask, V v) { return hn::IfThenElseZero(mask, v); }
};

/// Min or Max: NaN is replaced by the identity on the way in.
template <class M>
struct ExtremeLanes {
  using Lane = typename M::value_type;
  using D = hn::ScalableTag<Lane>;
  using V = hn::Vec<D>;
  static HWY_INLINE V identity() { return hn::Set(D(), M().identity()); }
  static HWY_INLINE V apply(V a, V b) {
    if constexpr (std::is_same_v<M, Min<Lane>>) return hn::Min(a, b);
    return hn::Max(a, b);
  }
  static HWY_INLINE V clean(V v) {
    if constexpr (hwy::IsFloat<Lane>()) return hn::IfThenElse(hn::IsNaN(v), identity(), v);
    return v;
  }
  static HWY_INLINE V select(hn::Mask<D> mask, V v) { return hn::IfThenElse(mask, v, identity()); }
};

/// What comes before the group at hand, in all lanes.
template <class Op, class M>
class LaneCarry {
 public:
  using V = typename Op::V;
  using Scalar = typename Op::Lane;
  using monoid = M;

  LaneCarry(Scalar prefix, Scalar local)
      : prefix_(hn::Set(typename Op::D(), prefix)), local_(hn::Set(typename Op::D(), local)) {}
  HWY_INLINE void begin_block() { base_ = Op::apply(prefix_, local_); }
  HWY_INLINE V start(V before_strip) const { return Op::apply(base_, before_strip); }
  HWY_INLINE void advance(V total) {
    local_ = Op::apply(local_, total);
    base_ = Op::apply(prefix_, local_);
  }
  HWY_INLINE void end_block() {}
  [[nodiscard]] Scalar local() const { return hn::GetLane(local_); }

  /// Folds lane by lane.
  class Lanes {
   public:
    Lanes() : lanes_(hn::Set(typename Op::D(), M().identity())) {}
    HWY_INLINE void add(V v) { lanes_ = Op::apply(lanes_, v); }
    [[nodiscard]] Scalar fold() const {
      alignas(64) Scalar lane[hn::MaxLanes(typename Op::D())];
      hn::Store(lanes_, typename Op::D(), lane);
      return std::accumulate(std::begin(lane), std::end(lane), M().identity(), M());
    }

   private:
    V lanes_;
  };

 private:
  V prefix_, local_, base_;
};

/// The same for float32 elements with the carry in float64: as the sum of two float32 it costs one
/// more addition, not a conversion of every element.
class WideCarry {
 public:
  using Op = PlusLanes<float>;
  using V = Op::V;
  using Scalar = double;
  using monoid = Plus<double>;

  WideCarry(double prefix, double local) : prefix_(prefix), local_(local) {}
  HWY_INLINE void begin_block() {
    const double before = prefix_ + local_;
    const auto high = static_cast<float>(before);
    const auto low = static_cast<float>(before - static_cast<double>(high));
    high_ = hn::Set(Op::D(), high);
    low_ = hn::Set(Op::D(), std::isfinite(high) ? low : 0.0F);
    total_ = hn::Zero(Op::D());
  }
  HWY_INLINE V start(V before_strip) const { return hn::Add(high_, hn::Add(low_, before_strip)); }
  HWY_INLINE void advance(V total) {
    low_ = hn::Add(low_, total);
    total_ = hn::Add(total_, total);
  }
  HWY_INLINE void end_block() { local_ += static_cast<double>(hn::GetLane(total_)); }
  [[nodiscard]] double local() const { return local_; }

  class Lanes {
   public:
    Lanes() {}  // not implicit: GCC would compile that for no instruction set
    HWY_INLINE void add(V v) {
      low_.add(hn::PromoteTo(Wide(), hn::LowerHalf(v)));
      high_.add(hn::PromoteTo(Wide(), hn::UpperHalf(hn::Half<Op::D>(), v)));
    }
    [[nodiscard]] double fold() const { return low_.fold() + high_.fold(); }

   private:
    using Wide = PlusLanes<double>::D;
    LaneCarry<PlusLanes<double>, Plus<double>>::Lanes low_, high_;
  };

 private:
  double prefix_, local_;
  V high_, low_, total_;
};

/// What the vectors do: whole blocks of two groups each. Both functions extend `local` by the
/// blocks and return how many elements they hold.
template <class Op, class CarryState, class In, class Out>
class Blocks {
 public:
  using Carry = typename CarryState::monoid::value_type;

  template <bool kInclusive>
  static std::size_t scan(const In* in, std::size_t count, Out* out, Carry prefix, Carry& local) {
    const StripOrder<Op> order;
    CarryState carry(prefix, local);
    std::size_t i = 0;
    for (; i + kBlock <= count; i += kBlock) scan_block<kInclusive>(order, in + i, out + i, carry);
    local = carry.local();
    return i;
  }

  static std::size_t fold(const In* in, std::size_t count, Carry& local) {
    const StripOrder<Op> order;
    CarryState carry(typename CarryState::monoid().identity(), local);
    std::size_t i = 0;
    for (; i + kBlock <= count; i += kBlock) fold_block(order, in + i, carry);
    local = carry.local();
    return i;
  }

  static std::size_t quick_fold(const In* in, std::size_t count, Carry& total) {
    typename CarryState::Lanes lanes;
    std::size_t i = 0;
    for (; i + kBlock <= count; i += kBlock) lanes.add(fold_rows<kBlock / kLanes>(in + i));
    total = lanes.fold();
    return i;
  }

 private:
  using T = typename Op::Lane;
  using D = typename Op::D;
  using V = typename Op::V;
  static constexpr std::size_t kRows = 16 / sizeof(T), kLanes = hn::MaxLanes(D());
  static constexpr std::size_t kGroups = 2, kGroup = kRows * kLanes, kBlock = kGroups * kGroup;
  static_assert(kRunGranule % kBlock == 0);

  static HWY_INLINE V load(const In* p) {
    if constexpr (std::is_same_v<In, T>) return Op::clean(hn::LoadU(D(), p));
    if constexpr (!std::is_same_v<In, T>)
      return hn::PromoteTo(D(), hn::LoadU(hn::Rebind<In, D>(), p));
  }
  static HWY_INLINE void store(V v, Out* p) {
    if constexpr (std::is_same_v<Out, T>) hn::StoreU(v, D(), p);
    if constexpr (!std::is_same_v<Out, T>) {
      const hn::Rebind<Out, D> narrow;
      hn::StoreU(hn::DemoteTo(narrow, v), narrow, p);
    }
  }
  /// Of so many vectors, lane by lane, in pairs.
  template <std::size_t kCount>
  static HWY_INLINE V fold_rows(const In* in) {
    if constexpr (kCount == 1)
      return load(in);
    else
      return Op::apply(fold_rows<kCount / 2>(in), fold_rows<kCount / 2>(in + kCount / 2 * kLanes));
  }
  /// Strips of a group, scanned.
  static HWY_INLINE void load_strips(const In* in, V (&row)[kRows]) {
    for (std::size_t k = 0; k < kRows; ++k) row[k] = load(in + k * kLanes);
    transpose_blocks<D>(row);
    for (std::size_t k = 1; k < kRows; ++k) row[k] = Op::apply(row[k - 1], row[k]);
  }
  /// Every strip's scan behind its `start`.
  template <bool kInclusive>
  static HWY_INLINE void store_strips(V start, V (&row)[kRows], Out* out) {
    V result[kRows];
    for (std::size_t k = 0; k < kRows; ++k) {
      if constexpr (kInclusive) result[k] = Op::apply(start, row[k]);
      if constexpr (!kInclusive) result[k] = k == 0 ? start : Op::apply(start, row[k - 1]);
    }
    transpose_blocks<D>(result);
    for (std::size_t k = 0; k < kRows; ++k) store(result[k], out + k * kLanes);
  }

  template <bool kInclusive>
  static HWY_INLINE void scan_block(const StripOrder<Op>& order, const In* in, Out* out,
                                    CarryState& carry) {
    V row[kGroups][kRows], totals[kGroups], start[kGroups];
    for (std::size_t g = 0; g < kGroups; ++g) {
      load_strips(in + g * kGroup, row[g]);
      totals[g] = order.scan(row[g][kRows - 1]);
    }
    carry.begin_block();
    for (std::size_t g = 0; g < kGroups; ++g) {
      start[g] = carry.start(order.previous(totals[g]));
      carry.advance(order.last(totals[g]));
    }
    carry.end_block();
    for (std::size_t g = 0; g < kGroups; ++g)
      store_strips<kInclusive>(start[g], row[g], out + g * kGroup);
  }

  static HWY_INLINE void fold_block(const StripOrder<Op>& order, const In* in, CarryState& carry) {
    carry.begin_block();
    for (std::size_t g = 0; g < kGroups; ++g) {
      V row[kRows];
      load_strips(in + g * kGroup, row);
      carry.advance(order.last(order.scan(row[kRows - 1])));
    }
    carry.end_block();
  }
};

#endif  // HWY_TARGET == HWY_SCALAR

/// Blocks, then what is left, one by one.
template <class Op, class CarryState, class In, class Out>
struct Scan {
  using M = typename CarryState::monoid;
  using Carry = typename M::value_type;
  using Vectors = Blocks<Op, CarryState, In, Out>;
  template <bool kInclusive>
  static Carry scan(const In* in, std::size_t count, Out* out, Carry prefix, Carry local) {
    const M m;
    std::size_t i = Vectors::template scan<kInclusive>(in, count, out, prefix, local);
    for (; i < count; ++i) {
      const Carry next = m(local, static_cast<Carry>(in[i]));
      out[i] = static_cast<Out>(m(prefix, kInclusive ? next : local));
      local = next;
    }
    return local;
  }

  static Carry fold(const In* in, std::size_t count, Carry local) {
    const M m;
    for (std::size_t i = Vectors::fold(in, count, local); i < count; ++i)
      local = m(local, static_cast<Carry>(in[i]));
    return local;
  }

  static Carry quick_fold(const In* in, std::size_t count) {
    const M m;
    Carry total = m.identity();
    for (std::size_t i = Vectors::quick_fold(in, count, total); i < count; ++i)
      total = m(total, static_cast<Carry>(in[i]));
    return total;
  }

  static constexpr ScanKernel<In, Carry, Out> kernel() {
    return {fold, quick_fold, scan<true>, scan<false>};
  }
};

template <class In, class T, class Out>
constexpr auto plus() {
  return Scan<PlusLanes<T>, LaneCarry<PlusLanes<T>, Plus<T>>, In, Out>::kernel();
}

template <class M, class T = typename M::value_type>
constexpr PlainKernel<T> extreme() {
  return Scan<ExtremeLanes<M>, LaneCarry<ExtremeLanes<M>, M>, T, T>::kernel();
}

ScanKernels kernels() {
  ScanKernels k{};
  k.name = hwy::TargetName(HWY_TARGET);
  k.plus_float = Scan<PlusLanes<float>, WideCarry, float, float>::kernel();
  k.plus_double_of_float = plus<float, double, float>();
  k.plus_float_to_double = plus<float, double, double>();
  k.plus_double = plus<double, double, double>();
  k.plus_int32 = plus<std::int32_t, std::int32_t, std::int32_t>();
  k.plus_uint32 = plus<std::uint32_t, std::uint32_t, std::uint32_t>();
  k.plus_int64 = plus<std::int64_t, std::int64_t, std::int64_t>();
  k.plus_uint64 = plus<std::uint64_t, std::uint64_t, std::uint64_t>();
  k.min_float = extreme<Min<float>>(), k.max_float = extreme<Max<float>>();
  k.min_double = extreme<Min<double>>(), k.max_double = extreme<Max<double>>();
  k.min_int32 = extreme<Min<std::int32_t>>(), k.max_int32 = extreme<Max<std::int32_t>>();
  k.min_uint32 = extreme<Min<std::uint32_t>>(), k.max_uint32 = extreme<Max<std::uint32_t>>();
  return k;
}

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "relumbre/base/instruction_sets-inl.h"

namespace relumbre {

HWY_EXPORT(kernels);

const ScanKernels& best_scan_kernels() {
  static const ScanKernels best = HWY_DYNAMIC_DISPATCH(kernels)();
  return best;
}

std::vector<ScanKernels> available_scan_kernels() {
  return on_every_instruction_set([] { return HWY_DYNAMIC_DISPATCH(kernels)(); });
}

}  // namespace relumbre
#endif  // HWY_ONCE
