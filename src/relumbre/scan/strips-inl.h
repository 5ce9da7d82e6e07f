// Strips: how a vector kernel arranges its elements. Included once per instruction set.
//
// A group is K vectors of N lanes, K being the lanes of 16 bytes. Its elements in memory, for K = 4
// and N = 8, in hexadecimal, and after each 16-byte block of four vectors has been transposed:
//
//     a  0123 4567        04 08 0c 10 ...    a  048c... : lane p of all vectors together holds a
//     b  89ab cdef   →                       b  159d...   strip of K consecutive elements
//     c  ....                                c  26ae...
//     d  ....                                d  37bf...
//
// Strips are then scanned vertically, with K - 1 operations for all N of them. The N totals are
// scanned within one vector in log₂ N steps, each a permutation by the strips' order and an
// operation, and what comes before a strip is added to all of it. Per vector that is 5 shuffles and
// 3 additions, where a scan within each vector would take 5 and 6.

#include <cstddef>

#include <hwy/highway.h>

#if defined(RELUMBRE_SCAN_STRIPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMBRE_SCAN_STRIPS_INL_H_
#undef RELUMBRE_SCAN_STRIPS_INL_H_
#else
#define RELUMBRE_SCAN_STRIPS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

/// Permutations of the lanes of a vector of strip totals.
template <class Op>
class StripOrder {
 public:
  using T = typename Op::Lane;
  using D = typename Op::D;
  using V = typename Op::V;
  static constexpr std::size_t kLanes = hn::MaxLanes(D());
  static constexpr std::size_t kInBlock = 16 / sizeof(T), kBlocks = kLanes / kInBlock;

  StripOrder() {
    static constexpr Tables tables;
    const hn::RebindToSigned<D> di;
    for (std::size_t s = 0; s < kSteps; ++s) {
      from_[s] = hn::SetTableIndices(D(), tables.from[s]);
      exists_[s] = hn::RebindMask(D(), hn::Gt(hn::Load(di, tables.exists[s]), hn::Zero(di)));
    }
    last_ = hn::SetTableIndices(D(), tables.last);
  }
  /// The totals scanned, inclusive.
  HWY_INLINE V scan(V totals) const {
    for (std::size_t s = 0; s < kSteps; ++s) totals = Op::apply(shifted(totals, s), totals);
    return totals;
  }
  /// From the strip before; the identity for the first.
  HWY_INLINE V previous(V totals) const { return shifted(totals, 0); }
  HWY_INLINE V last(V totals) const { return hn::TableLookupLanes(totals, last_); }

 private:
  using Index = hwy::MakeSigned<T>;
  static constexpr std::size_t kSteps = hwy::CeilLog2(kLanes);
  static constexpr std::size_t strip_of(std::size_t p) {
    return p % kInBlock * kBlocks + p / kInBlock;
  }
  static constexpr std::size_t lane_of(std::size_t q) {
    return q % kBlocks * kInBlock + q / kBlocks;
  }
  /// Where each lane's strip finds the one 2ˢ before it, whether there is one, and the last strip.
  struct Tables {
    alignas(64) Index from[kSteps][kLanes] = {};
    alignas(64) Index exists[kSteps][kLanes] = {};
    alignas(64) Index last[kLanes] = {};
    constexpr Tables() {
      for (std::size_t p = 0; p < kLanes; ++p) {
        for (std::size_t s = 0, q = strip_of(p); s < kSteps; ++s) {
          exists[s][p] = q >= (std::size_t{1} << s);
          if (exists[s][p]) from[s][p] = static_cast<Index>(lane_of(q - (std::size_t{1} << s)));
        }
        last[p] = static_cast<Index>(lane_of(kLanes - 1));
      }
    }
  };
  HWY_INLINE V shifted(V v, std::size_t s) const {
    return Op::select(exists_[s], hn::TableLookupLanes(v, from_[s]));
  }

  decltype(hn::SetTableIndices(D(), static_cast<const Index*>(nullptr))) from_[kSteps], last_;
  hn::Mask<D> exists_[kSteps];
};

/// Its own inverse.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void transpose_blocks(V (&v)[4]) {
  const D d;
  const hn::RepartitionToWide<D> wide;
  const auto low = hn::BitCast(wide, hn::InterleaveLower(d, v[0], v[1]));
  const auto low2 = hn::BitCast(wide, hn::InterleaveLower(d, v[2], v[3]));
  const auto high = hn::BitCast(wide, hn::InterleaveUpper(d, v[0], v[1]));
  const auto high2 = hn::BitCast(wide, hn::InterleaveUpper(d, v[2], v[3]));
  v[0] = hn::BitCast(d, hn::InterleaveLower(wide, low, low2));
  v[1] = hn::BitCast(d, hn::InterleaveUpper(wide, low, low2));
  v[2] = hn::BitCast(d, hn::InterleaveLower(wide, high, high2));
  v[3] = hn::BitCast(d, hn::InterleaveUpper(wide, high, high2));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE void transpose_blocks(V (&v)[2]) {
  const V low = hn::InterleaveLower(D(), v[0], v[1]);
  v[1] = hn::InterleaveUpper(D(), v[0], v[1]);
  v[0] = low;
}

#endif  // HWY_TARGET != HWY_SCALAR

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
