/// Sums and scans within a warp; all 32 lanes call them together.
#pragma once

#include <cuda_runtime.h>

#include "relumbre/cuda/launch.cuh"

namespace relumbre::cuda {

inline constexpr unsigned kWarp = 32;
inline constexpr unsigned kAllLanes = 0xFFFFFFFFU;

/// Values of any size by words: shuffles know 4 and 8 bytes only.
template <class T>
__device__ __forceinline__ T shuffle_up(const T& value, unsigned by) {
  if constexpr (sizeof(T) <= 8 && std::is_arithmetic_v<T>) {
    return __shfl_up_sync(kAllLanes, value, by);
  } else {
    constexpr std::size_t words = (sizeof(T) + 3) / 4;
    unsigned in[words] = {}, out[words];
    memcpy(in, &value, sizeof(T));
#pragma unroll
    for (std::size_t i = 0; i < words; ++i) out[i] = __shfl_up_sync(kAllLanes, in[i], by);
    T result;
    memcpy(&result, out, sizeof(T));
    return result;
  }
}
template <class T>
__device__ __forceinline__ T shuffle(const T& value, unsigned from) {
  if constexpr (sizeof(T) <= 8 && std::is_arithmetic_v<T>) {
    return __shfl_sync(kAllLanes, value, static_cast<int>(from));
  } else {
    constexpr std::size_t words = (sizeof(T) + 3) / 4;
    unsigned in[words] = {}, out[words];
    memcpy(in, &value, sizeof(T));
#pragma unroll
    for (std::size_t i = 0; i < words; ++i)
      out[i] = __shfl_sync(kAllLanes, in[i], static_cast<int>(from));
    T result;
    memcpy(&result, out, sizeof(T));
    return result;
  }
}

/// Lane i gets v_0 ∘ ... ∘ v_i.
template <class T, class Op>
__device__ __forceinline__ T warp_inclusive_scan(T value, unsigned lane, const Op& op) {
#pragma unroll
  for (unsigned by = 1; by < kWarp; by *= 2) {
    const T before = shuffle_up(value, by);
    if (lane >= by) value = op(before, value);
  }
  return value;
}

/// The sum of all lanes in every lane, by the same tree always.
__device__ __forceinline__ float warp_sum(float value) {
#pragma unroll
  for (int by = 16; by > 0; by /= 2) value += __shfl_xor_sync(kAllLanes, value, by);
  return value;
}

}  // namespace relumbre::cuda
