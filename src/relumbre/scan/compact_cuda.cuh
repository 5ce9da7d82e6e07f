/// Stream compaction on a GPU: the twin of compact.h.
#pragma once

#include <concepts>
#include <cstdint>

#include "relumbre/scan/scan_tiles_cuda.cuh"

namespace relumbre::cuda {

namespace scan_detail {

/// Counts what is kept, and puts it where the count says.
template <class T, class Keep>
struct Compaction {
  using Value = std::uint64_t;
  static constexpr unsigned kVector = kPackOf<T, T>;
  using Items = Pack<T, kVector>;

  const T* in;
  T* out;
  Keep keep;
  bool aligned;

  template <bool kWhole>
  __device__ Items load(std::size_t first, unsigned count) const {
    if constexpr (kWhole) return load_pack<kVector>(in + first, aligned);
    return load_part<kVector>(in + first, count);
  }
  __device__ Value value(const Items& items, unsigned k) const {
    return keep(items.values[k]) ? 1 : 0;
  }
  template <bool kWhole>
  __device__ void store(std::size_t, unsigned count, const Value (&before)[kVector],
                        const Items& items) const {
#pragma unroll
    for (unsigned k = 0; k < kVector; ++k)
      if ((kWhole || k < count) && keep(items.values[k])) out[before[k]] = items.values[k];
  }
};

/// The same of elements that flags say to keep.
template <class T, class Flag>
struct FlaggedCompaction {
  using Value = std::uint64_t;
  static constexpr unsigned kVector = kPackOf<T, Flag>;
  struct Items {
    Pack<T, kVector> values;
    Pack<Flag, kVector> flags;
  };

  const T* in;
  const Flag* flags;
  T* out;
  bool aligned, aligned_flags;

  template <bool kWhole>
  __device__ Items load(std::size_t first, unsigned count) const {
    if constexpr (kWhole)
      return {load_pack<kVector>(in + first, aligned),
              load_pack<kVector>(flags + first, aligned_flags)};
    return {load_part<kVector>(in + first, count), load_part<kVector>(flags + first, count)};
  }
  __device__ Value value(const Items& items, unsigned k) const {
    return items.flags.values[k] != 0 ? 1 : 0;
  }
  template <bool kWhole>
  __device__ void store(std::size_t, unsigned count, const Value (&before)[kVector],
                        const Items& items) const {
#pragma unroll
    for (unsigned k = 0; k < kVector; ++k)
      if ((kWhole || k < count) && items.flags.values[k] != 0)
        out[before[k]] = items.values.values[k];
  }
};

}  // namespace scan_detail

/// Copies the elements for which keep(element), callable on the device, holds to the front of
/// `out`, in their order; `kept`, if it is given, becomes their number. What lies behind them in
/// `out`, which has room for `size`, is left alone. All pointers are to device memory; input and
/// output must not overlap. `keep` is called twice for an element and must return the same. Reads
/// memory once.
template <class T, class Keep>
requires std::predicate<Keep, T>
void compact(const T* in, std::size_t size, T* out, const Keep& keep, ScanScratch& scratch,
             const Stream& stream, std::uint64_t* kept = nullptr) {
  const scan_detail::Compaction<T, Keep> io{in, out, keep, is_aligned<kPackOf<T, T>>(in)};
  scan_detail::scan<ScanKind::kExclusive>(io, size, Plus<std::uint64_t>{}, scratch, stream, kept);
}

/// The same of the elements with flags[i] ≠ 0.
template <class T, std::integral Flag>
void compact_flagged(const T* in, const Flag* flags, std::size_t size, T* out, ScanScratch& scratch,
                     const Stream& stream, std::uint64_t* kept = nullptr) {
  using Io = scan_detail::FlaggedCompaction<T, Flag>;
  const Io io{in, flags, out, is_aligned<Io::kVector>(in), is_aligned<Io::kVector>(flags)};
  scan_detail::scan<ScanKind::kExclusive>(io, size, Plus<std::uint64_t>{}, scratch, stream, kept);
}

}  // namespace relumbre::cuda
