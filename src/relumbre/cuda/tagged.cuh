/// Values and numbers that blocks of one grid hand to one another, without fences and without
/// memory that has to be cleared before every grid.
#pragma once

#include <cstdint>

#include <cuda_runtime.h>

#include "relumbre/cuda/ptx.cuh"

namespace relumbre::cuda {

/// Words of a T that is published.
template <class T>
inline constexpr unsigned kTaggedWords = (sizeof(T) + 3) / 4;

/// Publishes a value. Each word of 64 bits carries a part of it and says what it is:
///
///     │63          32│31           0│
///     │     tag      │ 4 bytes of T │   × kTaggedWords<T>
///
/// Words are written and read whole, so a reader that finds its tag in every one of them has all of
/// the value, and neither side needs a fence, which would cost more than the words do. A place gets
/// a tag once only.
template <class T>
__device__ __forceinline__ void store_tagged(std::uint64_t* words, const T& value,
                                             std::uint32_t tag) {
  std::uint32_t parts[kTaggedWords<T>] = {};
  memcpy(parts, &value, sizeof(T));
#pragma unroll
  for (unsigned i = 0; i < kTaggedWords<T>; ++i)
    store_relaxed(words + i, std::uint64_t{tag} << 32 | parts[i]);
}

/// The tag that all words carry, and the value. 0, which is nobody's tag, if they differ: `value`
/// is then being written and of no use.
template <class T>
__device__ __forceinline__ std::uint32_t load_tagged(const std::uint64_t* words, T& value) {
  std::uint64_t loaded[kTaggedWords<T>];
#pragma unroll
  for (unsigned i = 0; i < kTaggedWords<T>; ++i) loaded[i] = load_relaxed(words + i);
  std::uint32_t parts[kTaggedWords<T>];
  const auto tag = static_cast<std::uint32_t>(loaded[0] >> 32);
  bool same = true;
#pragma unroll
  for (unsigned i = 0; i < kTaggedWords<T>; ++i) {
    parts[i] = static_cast<std::uint32_t>(loaded[i]);
    same = same && static_cast<std::uint32_t>(loaded[i] >> 32) == tag;
  }
  memcpy(&value, parts, sizeof(T));
  return same ? tag : 0;
}

/// A block's place in the order in which blocks start. A block may wait for those with smaller
/// numbers, which run or have run; blockIdx says nothing of the kind.
struct Ticket {
  std::uint32_t number;  ///< from 0
  /// Even and not 0. It and tag + 1 belong to this grid alone, so that words of older grids do not
  /// have them (for 2^31 grids).
  std::uint32_t tag;
};

/// By one thread of each block. The counter is 0 before the first grid ever; the last block of
/// every grid makes it ready for the next one, so grids that share it must run one after the other.
__device__ __forceinline__ Ticket take_ticket(unsigned long long* counter, std::uint32_t blocks) {
  constexpr std::uint32_t kLastEpoch = (1U << 31) - 1;
  const unsigned long long before = atomicAdd(counter, 1ULL);
  const auto number = static_cast<std::uint32_t>(before);
  const auto epoch = static_cast<std::uint32_t>(before >> 32) + 1;
  if (number == blocks - 1)
    atomicExch(counter, static_cast<unsigned long long>(epoch % kLastEpoch) << 32);
  return {number, 2 * epoch};
}

}  // namespace relumbre::cuda
