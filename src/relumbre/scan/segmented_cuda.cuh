/// Scans on a GPU that begin anew at every head of a segment: the twins of segmented.h.
///
/// As in scan_cuda.cuh; a segment's exclusive scan begins with the identity, and the first element
/// begins a segment in any case. `total` gets the fold of the last segment. Heads and keys must not
/// overlap the output; an exclusive scan reads them once all the same.
#pragma once

#include <concepts>

#include "relumbre/scan/scan_tiles_cuda.cuh"

namespace relumbre::cuda {

namespace scan_detail {

/// Whether the elements from `first` on begin segments, a bit each.
template <std::integral Flag>
struct Flags {
  static constexpr std::size_t kBytes = sizeof(Flag);
  const Flag* flags;

  template <unsigned kVector, bool kWhole>
  __device__ unsigned heads(std::size_t first, unsigned count) const {
    Pack<Flag, kVector> pack;
    if constexpr (kWhole)
      pack = load_pack<kVector>(flags + first, is_aligned<kVector>(flags));
    else
      pack = load_part<kVector>(flags + first, count);
    unsigned bits = 0;
#pragma unroll
    for (unsigned k = 0; k < kVector; ++k) bits |= pack.values[k] != 0 ? 1U << k : 0U;
    return bits;
  }
};

/// Where a key differs from the one before it. That one belongs to another lane, which has it in
/// the first-level cache.
template <class Key>
struct Changes {
  static constexpr std::size_t kBytes = sizeof(Key);
  const Key* keys;

  template <unsigned kVector, bool kWhole>
  __device__ unsigned heads(std::size_t first, unsigned count) const {
    if (!kWhole && count == 0) return 0;
    Pack<Key, kVector> pack;
    if constexpr (kWhole)
      pack = load_pack<kVector>(keys + first, is_aligned<kVector>(keys));
    else
      pack = load_part<kVector>(keys + first, count);
    unsigned bits = first == 0 || !(keys[first - 1] == pack.values[0]) ? 1 : 0;
#pragma unroll
    for (unsigned k = 1; k < kVector; ++k)
      bits |= pack.values[k - 1] == pack.values[k] ? 0U : 1U << k;
    return bits;
  }
};

/// Arrays of which the elements carry heads.
template <class In, class Out, Monoid M, class Heads, ScanKind kKind>
struct SegmentedArrays {
  using Value = Headed<typename M::value_type>;
  using Plain = Arrays<In, Out, M>;
  static constexpr unsigned kVector = Plain::kVector;
  struct Items {
    typename Plain::Items plain;
    unsigned heads;
  };

  Plain arrays;
  Heads heads;
  M m;

  template <bool kWhole>
  __device__ Items load(std::size_t first, unsigned count) const {
    return {arrays.template load<kWhole>(first, count),
            heads.template heads<kVector, kWhole>(first, count)};
  }
  __device__ Value value(const Items& items, unsigned k) const {
    return {(items.heads >> k & 1) != 0, arrays.value(items.plain, k)};
  }
  template <bool kWhole>
  __device__ void store(std::size_t first, unsigned count, const Value (&results)[kVector],
                        const Items& items) const {
    typename M::value_type plain[kVector];
#pragma unroll
    for (unsigned k = 0; k < kVector; ++k) {
      const bool begins = kKind == ScanKind::kExclusive && (items.heads >> k & 1) != 0;
      plain[k] = begins ? m.identity() : results[k].value;
    }
    arrays.template store<kWhole>(first, count, plain, items.plain);
  }
};

template <ScanKind kKind, class In, class Out, Monoid M, class Heads>
void scan_segments(const In* in, std::size_t size, Out* out, const Heads& heads,
                   ScanScratch& scratch, const Stream& stream, const M& m,
                   Headed<typename M::value_type>* total) {
  const SegmentedArrays<In, Out, M, Heads, kKind> io{Arrays<In, Out, M>(in, out), heads, m};
  scan<kKind>(io, size, Segmented<M>{m}, scratch, stream, total);
}

template <class In, class Out, Monoid M, class Heads>
void scan_segments(const In* in, std::size_t size, Out* out, const Heads& heads,
                   ScanScratch& scratch, const Stream& stream, const M& m, ScanKind kind,
                   Headed<typename M::value_type>* total) {
  if (kind == ScanKind::kInclusive)
    scan_segments<ScanKind::kInclusive>(in, size, out, heads, scratch, stream, m, total);
  else
    scan_segments<ScanKind::kExclusive>(in, size, out, heads, scratch, stream, m, total);
}

}  // namespace scan_detail

/// heads[i] ≠ 0: a segment begins at i.
template <class In, std::integral Flag, class Out, Monoid M = DefaultPlus<In, Out>>
void segmented_scan(const In* in, const Flag* heads, std::size_t size, Out* out,
                    ScanScratch& scratch, const Stream& stream, const M& m = {},
                    ScanKind kind = ScanKind::kInclusive,
                    Headed<typename M::value_type>* total = nullptr) {
  scan_detail::scan_segments(in, size, out, scan_detail::Flags<Flag>{heads}, scratch, stream, m,
                             kind, total);
}

/// A segment begins wherever a key differs from the one before it.
template <std::equality_comparable Key, class In, class Out, Monoid M = DefaultPlus<In, Out>>
void scan_by_key(const Key* keys, const In* in, std::size_t size, Out* out, ScanScratch& scratch,
                 const Stream& stream, const M& m = {}, ScanKind kind = ScanKind::kInclusive,
                 Headed<typename M::value_type>* total = nullptr) {
  scan_detail::scan_segments(in, size, out, scan_detail::Changes<Key>{keys}, scratch, stream, m,
                             kind, total);
}

}  // namespace relumbre::cuda
