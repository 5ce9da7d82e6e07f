#include "relumbre/sat/sat_kernels.h"

#include <bit>
#include <type_traits>
#include <utility>

// Vectors are members of classes, which SVE's cannot be.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relumbre/sat/sat_kernels.cpp"
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// kLanes numbers as one value, which the compiler keeps in vector registers.
template <class T, std::size_t kLanes>
struct VectorOf {
  typedef T type __attribute__((vector_size(kLanes * sizeof(T))));
};
template <class T, std::size_t kLanes>
using Vector = typename VectorOf<T, kLanes>::type;

/// The same at any address of a T.
template <class T, class V>
struct UnalignedOf {
  typedef T type __attribute__((vector_size(sizeof(V)), aligned(alignof(T)), may_alias));
};

template <class V, class T>
HWY_INLINE void load(const T* from, V& to) {
  to = *reinterpret_cast<const typename UnalignedOf<T, V>::type*>(from);
}
template <class V, class T>
HWY_INLINE void store(const V& from, T* to) {
  *reinterpret_cast<typename UnalignedOf<T, V>::type*>(to) = from;
}

/// The low bits of 1.5 · 2^52 + x are those of the integer nearest to x, for |x| < 2^51.
constexpr double kRounder = 6755399441055744.0;

/// Summands that are there already.
template <class T, std::size_t kLanes>
class Summands {
 public:
  HWY_INLINE explicit Summands(const SatConversion&) {}
  HWY_INLINE void get(const T* from, std::size_t, Vector<T, kLanes>& to) { load(from, to); }
  HWY_INLINE bool inside() const { return true; }
};

/// Summands made from floats, kLanes at a time.
template <class T, std::size_t kLanes>
class Floats;

template <std::size_t kLanes>
class Floats<float, kLanes> {
 public:
  HWY_INLINE explicit Floats(const SatConversion& how) : subtrahend_(how.subtrahend) {}
  HWY_INLINE void get(const float* from, std::size_t lane, Vector<float, kLanes>& to) {
    Vector<float, kLanes> subtrahend;
    load(from, to);
    load(subtrahend_ + lane, subtrahend);
    to -= subtrahend;
  }
  HWY_INLINE bool inside() const { return true; }

 private:
  const float* subtrahend_;
};

template <std::size_t kLanes>
class Floats<double, kLanes> {
 public:
  HWY_INLINE explicit Floats(const SatConversion&) {}
  HWY_INLINE void get(const float* from, std::size_t, Vector<double, kLanes>& to) {
    Vector<float, kLanes> values;
    load(from, values);
    to = __builtin_convertvector(values, Vector<double, kLanes>);
  }
  HWY_INLINE bool inside() const { return true; }
};

template <std::size_t kLanes>
class Floats<std::uint32_t, kLanes> {
 public:
  HWY_INLINE explicit Floats(const SatConversion& how)
      : scale_(hn::Set(d_, static_cast<float>(how.scale))),
        lowest_(hn::Set(d_, how.lowest)),
        highest_(hn::Set(d_, how.highest)),
        inside_(hn::Eq(lowest_, lowest_)) {}
  HWY_INLINE void get(const float* from, std::size_t, Vector<std::uint32_t, kLanes>& to) {
    alignas(64) std::uint32_t rounded[kLanes];
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d_)) {
      const auto v = hn::LoadU(d_, from + i);
      inside_ = hn::And(inside_, hn::And(hn::Ge(v, lowest_), hn::Le(v, highest_)));
      hn::Store(hn::BitCast(integers_, hn::NearestInt(hn::Mul(v, scale_))), integers_, rounded + i);
    }
    load(rounded, to);
  }
  HWY_INLINE bool inside() const { return hn::AllTrue(d_, inside_); }

 private:
  static constexpr hn::CappedTag<float, kLanes> d_{};
  static constexpr hn::RebindToUnsigned<hn::CappedTag<float, kLanes>> integers_{};
  hn::Vec<hn::CappedTag<float, kLanes>> scale_, lowest_, highest_;
  hn::Mask<hn::CappedTag<float, kLanes>> inside_;
};

template <std::size_t kLanes>
class Floats<std::uint64_t, kLanes> {
 public:
  HWY_INLINE explicit Floats(const SatConversion& how)
      : scale_(hn::Set(d_, how.scale)),
        lowest_(hn::Set(d_, static_cast<double>(how.lowest))),
        highest_(hn::Set(d_, static_cast<double>(how.highest))),
        inside_(hn::Eq(lowest_, lowest_)) {}
  HWY_INLINE void get(const float* from, std::size_t, Vector<std::uint64_t, kLanes>& to) {
    alignas(64) std::uint64_t rounded[kLanes];
    const auto rounder = hn::Set(d_, kRounder);
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d_)) {
      const auto v = hn::PromoteTo(d_, hn::LoadU(narrow_, from + i));
      inside_ = hn::And(inside_, hn::And(hn::Ge(v, lowest_), hn::Le(v, highest_)));
      // The product is exact, so that fusing it with the sum changes nothing.
      const auto sum = hn::BitCast(integers_, hn::MulAdd(v, scale_, rounder));
      hn::Store(hn::Sub(sum, hn::BitCast(integers_, rounder)), integers_, rounded + i);
    }
    load(rounded, to);
  }
  HWY_INLINE bool inside() const { return hn::AllTrue(d_, inside_); }

 private:
  using Tag = hn::CappedTag<double, kLanes>;
  static constexpr Tag d_{};
  static constexpr hn::Rebind<float, Tag> narrow_{};
  static constexpr hn::RebindToUnsigned<Tag> integers_{};
  hn::Vec<Tag> scale_, lowest_, highest_;
  hn::Mask<Tag> inside_;
};

template <class In, class T, std::size_t kLanes>
using SummandsOf = std::conditional_t<std::is_same_v<In, T> && !std::is_same_v<T, float>,
                                      Summands<T, kLanes>, Floats<T, kLanes>>;

template <bool kStream, class T, class V>
HWY_INLINE void write(const V& sums, T* row) {
  constexpr std::size_t kLanes = sizeof(V) / sizeof(T);
  if constexpr (kStream) {
    const hn::CappedTag<T, kLanes> d;
    alignas(64) T copy[kLanes];
    store(sums, copy);
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d))
      hn::Stream(hn::Load(d, copy + i), d, row + i);
  } else {
    store(sums, row);
  }
}

/// sums += addend, written to the row too.
template <bool kStream, class T, class V>
HWY_INLINE void advance(const V& addend, T* sums, T* row) {
  V sum;
  load(sums, sum);
  sum += addend;
  store(sum, sums);
  write<kStream>(sum, row);
}

/// Lanes of four pixels, or of two, moved by one pixel or more, with zeros (index kLanes) or
/// repetitions: what the scans below add.
template <std::size_t kChannels>
struct Quad {
  static constexpr int kZero = 4 * kChannels;
  template <class V, std::size_t... i>
  static HWY_INLINE void odd_gets_even(const V& v, V& to, std::index_sequence<i...>) {  // 0 a 0 c
    to = __builtin_shufflevector(v, V{},
                                 (i / kChannels % 2 ? static_cast<int>(i - kChannels) : kZero)...);
  }
  template <class V, std::size_t... i>
  static HWY_INLINE void upper_gets_second(const V& v, V& to,
                                           std::index_sequence<i...>) {  // 0 0 b b
    to = __builtin_shufflevector(
        v, V{}, (i / kChannels >= 2 ? static_cast<int>(kChannels + i % kChannels) : kZero)...);
  }
  template <class V, std::size_t... i>
  static HWY_INLINE void last(const V& v, V& to, std::index_sequence<i...>) {  // d d d d
    to = __builtin_shufflevector(v, v, static_cast<int>(3 * kChannels + i % kChannels)...);
  }
};

template <std::size_t kChannels>
struct Pair {
  static constexpr int kZero = 2 * kChannels;
  template <class V, std::size_t... i>
  static HWY_INLINE void second_gets_first(const V& v, V& to, std::index_sequence<i...>) {  // 0 a
    to = __builtin_shufflevector(v, V{},
                                 (i / kChannels ? static_cast<int>(i - kChannels) : kZero)...);
  }
  template <class V, std::size_t... i>
  static HWY_INLINE void second(const V& v, V& to, std::index_sequence<i...>) {  // b b
    to = __builtin_shufflevector(v, v, static_cast<int>(kChannels + i % kChannels)...);
  }
};

template <std::size_t kCount>
using Lanes = std::make_index_sequence<kCount>;

/// Where four pixels come from and go to.
template <class In, class T>
struct Place {
  const In* values;
  T *sums, *row;
};

/// Four pixels are one vector.
template <bool kStream, class T, std::size_t kChannels, class Source, class In>
HWY_INLINE void scan_quad(Source& source, const Place<In, T>& at, std::size_t lane,
                          Vector<T, 4 * kChannels>& total) {
  using Move = Quad<kChannels>;
  constexpr Lanes<4 * kChannels> lanes;
  Vector<T, 4 * kChannels> v, moved;
  source.get(at.values, lane, v);
  Move::odd_gets_even(v, moved, lanes);
  v += moved;  // a, ab, c, cd
  Move::upper_gets_second(v, moved, lanes);
  v += moved;  // a, ab, abc, abcd
  advance<kStream>(total + v, at.sums, at.row);
  Move::last(v, moved, lanes);
  total += moved;
}

/// Two pixels are one vector.
template <bool kStream, class T, std::size_t kChannels, class Source, class In>
HWY_INLINE void scan_pairs(Source& source, const Place<In, T>& at, std::size_t lane,
                           Vector<T, 2 * kChannels>& total) {
  using Move = Pair<kChannels>;
  constexpr std::size_t kNext = 2 * kChannels;
  constexpr Lanes<kNext> lanes;
  Vector<T, kNext> low, high, moved;
  source.get(at.values, lane, low);
  source.get(at.values + kNext, lane + kNext, high);
  Move::second_gets_first(low, moved, lanes);
  low += moved;  // a, ab
  Move::second_gets_first(high, moved, lanes);
  high += moved;  // c, cd
  Move::second(low, moved, lanes);
  high += moved;  // abc, abcd
  advance<kStream>(total + low, at.sums, at.row);
  advance<kStream>(total + high, at.sums + kNext, at.row + kNext);
  Move::second(high, moved, lanes);
  total += moved;
}

/// A pixel is one vector of four lanes.
template <bool kStream, class T, class Source, class In>
HWY_INLINE void scan_singles(Source& source, const Place<In, T>& at, std::size_t lane,
                             Vector<T, 4>& total) {
  Vector<T, 4> a, b, c, d;
  source.get(at.values, lane, a);
  source.get(at.values + 4, lane + 4, b);
  source.get(at.values + 8, lane + 8, c);
  source.get(at.values + 12, lane + 12, d);
  d += c, b += a, c += b, d += b;
  advance<kStream>(total + a, at.sums, at.row);
  advance<kStream>(total + b, at.sums + 4, at.row + 4);
  advance<kStream>(total + c, at.sums + 8, at.row + 8);
  total += d;
  advance<kStream>(total, at.sums + 12, at.row + 12);
}

/// The same of three channels: the fourth lane belongs to the next pixel, which overwrites it; the
/// last of the four pixels leaves it out.
template <class T, class Source, class In>
HWY_INLINE void scan_triples(Source& source, const Place<In, T>& at, std::size_t lane,
                             Vector<T, 4>& total) {
  Vector<T, 4> a, b, c, d, p, q, r, s;
  source.get(at.values, lane, a);
  source.get(at.values + 3, lane + 3, b);
  source.get(at.values + 6, lane + 6, c);
  source.get(at.values + 9, lane + 9, d);
  load(at.sums, p), load(at.sums + 3, q), load(at.sums + 6, r), load(at.sums + 9, s);
  d += c, b += a, c += b, d += b;
  p += total + a, q += total + b, r += total + c;
  total += d;
  s += total;
  store(p, at.sums), store(q, at.sums + 3), store(r, at.sums + 6);
  for (std::size_t i = 0; i < 3; ++i) at.sums[9 + i] = s[i];
}

/// Pixels a vector, so that vectors are as long as the registers: 4, 2 or 1.
template <class T, std::size_t kChannels>
constexpr std::size_t pixels_per_vector() {
  if (kChannels == 3) return 1;
  if (kChannels == 1 || 4 * kChannels * sizeof(T) <= HWY_MAX_BYTES) return 4;
  return kChannels == 2 || 2 * kChannels * sizeof(T) <= HWY_MAX_BYTES ? 2 : 1;
}

template <bool kStream, class In, class T, std::size_t kChannels>
bool build_row(const SatRow<In, T>& part, const SatConversion& how) {
  constexpr std::size_t kPixels = pixels_per_vector<T, kChannels>();
  constexpr std::size_t kLanes = kPixels == 1 ? 4 : kPixels * kChannels;
  SummandsOf<In, T, kLanes> source(how);
  Vector<T, kLanes> total{};
  for (std::size_t i = 0; i < kLanes; ++i) total[i] = part.carry[kPixels == 1 ? i : i % kChannels];
  const In* const values = part.values;
  T *const sums = part.sums, *const row = part.row;
  const auto ahead =
      reinterpret_cast<std::uintptr_t>(values) + static_cast<std::uintptr_t>(part.ahead);
  const std::size_t count = part.pixels * kChannels;
  for (std::size_t i = 0; i < count; i += 4 * kChannels) {
    const std::size_t lane = i % (kSatGroup * kChannels);
    if (i * sizeof(In) % 64 < 4 * kChannels * sizeof(In))
      __builtin_prefetch(reinterpret_cast<const void*>(ahead + i * sizeof(In)), 0, 2);
    const Place<In, T> at{values + i, sums + i, row + i};
    if constexpr (kPixels == 4)
      scan_quad<kStream, T, kChannels>(source, at, lane, total);
    else if constexpr (kPixels == 2)
      scan_pairs<kStream, T, kChannels>(source, at, lane, total);
    else if constexpr (kChannels == 4)
      scan_singles<kStream>(source, at, lane, total);
    else
      scan_triples(source, at, lane, total);
  }
  if constexpr (kChannels == 3) {
    constexpr std::size_t kLine = 64 / sizeof(T);
    for (std::size_t i = 0; i < count; i += kLine) {
      Vector<T, kLine> line;
      load(sums + i, line);
      write<kStream>(line, row + i);
    }
  }
  for (std::size_t i = 0; i < kChannels; ++i) part.carry[i] = total[i];
  return source.inside();
}

template <bool kStream, class In, class T, class Kernel>
void set(Kernel (&kernels)[4]) {
  kernels[0] = build_row<kStream, In, T, 1>, kernels[1] = build_row<kStream, In, T, 2>;
  kernels[2] = build_row<kStream, In, T, 3>, kernels[3] = build_row<kStream, In, T, 4>;
}

template <class T>
SatKernels<T> kernels() {
  SatKernels<T> all;
  all.name = hwy::TargetName(HWY_TARGET);
  set<false, float, T>(all.store_floats), set<true, float, T>(all.stream_floats);
  set<false, T, T>(all.store_summands), set<true, T, T>(all.stream_summands);
  return all;
}

SatKernels<std::uint32_t> uint32_kernels() { return kernels<std::uint32_t>(); }
SatKernels<std::uint64_t> uint64_kernels() { return kernels<std::uint64_t>(); }
SatKernels<float> float_kernels() { return kernels<float>(); }
SatKernels<double> double_kernels() { return kernels<double>(); }

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "relumbre/base/instruction_sets-inl.h"

namespace relumbre {

HWY_EXPORT(uint32_kernels);
HWY_EXPORT(uint64_kernels);
HWY_EXPORT(float_kernels);
HWY_EXPORT(double_kernels);

namespace {

template <class T>
SatKernels<T> dispatched() {
  if constexpr (std::is_same_v<T, std::uint32_t>) return HWY_DYNAMIC_DISPATCH(uint32_kernels)();
  if constexpr (std::is_same_v<T, std::uint64_t>) return HWY_DYNAMIC_DISPATCH(uint64_kernels)();
  if constexpr (std::is_same_v<T, float>) return HWY_DYNAMIC_DISPATCH(float_kernels)();
  if constexpr (std::is_same_v<T, double>) return HWY_DYNAMIC_DISPATCH(double_kernels)();
}

}  // namespace

template <class T>
const SatKernels<T>& best_sat_kernels() {
  static const SatKernels<T> best = dispatched<T>();
  return best;
}

template <class T>
std::vector<SatKernels<T>> available_sat_kernels() {
  return on_every_instruction_set(dispatched<T>);
}

#define RELUMBRE_INSTANTIATE(T)                     \
  template const SatKernels<T>& best_sat_kernels(); \
  template std::vector<SatKernels<T>> available_sat_kernels();
RELUMBRE_INSTANTIATE(std::uint32_t)
RELUMBRE_INSTANTIATE(std::uint64_t)
RELUMBRE_INSTANTIATE(float)
RELUMBRE_INSTANTIATE(double)
#undef RELUMBRE_INSTANTIATE

}  // namespace relumbre
#endif  // HWY_ONCE
