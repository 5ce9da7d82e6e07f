/// Device-only: floats as integers of the same order, so that atomics find the least of them.
#pragma once

#include <cstdint>

#include <cuda_runtime.h>

#include "relumbre/cuda/ptx.cuh"
#include "relumbre/cuda/warp.cuh"

namespace relumbre::cuda {

/// Negative floats have all bits turned over, others the sign alone.
__device__ __forceinline__ std::uint32_t ordered(float value) {
  const std::uint32_t bits = __float_as_uint(value);
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
}
__device__ __forceinline__ float float_of(std::uint32_t ordered) {
  return __uint_as_float((ordered >> 31) != 0 ? ordered & 0x7FFFFFFFU : ~ordered);
}

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
