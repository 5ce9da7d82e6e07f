/// Device-only: the largest and the least of many.
#pragma once

#include <cstdint>

#include <cuda_runtime.h>

#include "relumbre/cuda/ptx.cuh"
#include "relumbre/cuda/warp.cuh"

namespace relumbre::cuda {

/// Only what is larger than what is there needs an atomic, which soon is nothing.
__device__ __forceinline__ void raise_to(std::uint32_t* at, std::uint32_t value) {
  if (value > load_relaxed(at)) atomicMax(at, value);
}
__device__ __forceinline__ void lower_to(std::uint32_t* at, std::uint32_t value) {
  if (value < load_relaxed(at)) atomicMin(at, value);
}

/// Of all lanes, in all lanes.
__device__ __forceinline__ std::uint32_t warp_largest(std::uint32_t value) {
#pragma unroll
  for (int by = 16; by > 0; by /= 2) {
    const std::uint32_t other = __shfl_xor_sync(kAllLanes, value, by);
    value = value > other ? value : other;
  }
  return value;
}

}  // namespace relumbre::cuda
