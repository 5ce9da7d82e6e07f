/// The small steps of the real-time stage: from elements to patches, and among patches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <cuda_fp16.h>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/warp.cuh"

namespace relumbre::cuda {

inline constexpr unsigned kPatchThreads = 256;
inline constexpr float kLargestFloat = std::numeric_limits<float>::max();

/// Of the elements' values of every source: emission[s][element][channel].
struct Emission {
  const float* values;  ///< on the device, or page-locked on the host
  float* copy;          ///< where they are also put, if not null
  std::size_t elements;
  unsigned sources;
};

/// mean[s][c][p] = Σ over the elements of patch p of weight · emission, by groups of kGroup lanes.
/// Sets *not_finite if any mean is not. Grid: sources · patches groups.
template <unsigned kGroup>
__global__ void gather_patches(Emission emission, const float* weight, const std::uint32_t* offsets,
                               unsigned patches, float* mean, unsigned* not_finite) {
  const std::size_t group = (std::size_t{blockIdx.x} * kPatchThreads + threadIdx.x) / kGroup;
  const bool inside = group < std::size_t{emission.sources} * patches;
  const auto source = inside ? group / patches : 0;
  const auto patch = static_cast<unsigned>(inside ? group % patches : 0);
  float sum[3] = {};
  if (inside) {
    const std::size_t first = source * 3 * emission.elements;
    const float* values = emission.values + first;
    float* copy = emission.copy == nullptr ? nullptr : emission.copy + first;
    for (std::size_t j = offsets[patch] + threadIdx.x % kGroup; j < offsets[patch + 1];
         j += kGroup) {
      const float w = weight[j];
#pragma unroll
      for (unsigned c = 0; c < 3; ++c) {
        const float e = values[3 * j + c];
        if (copy != nullptr) copy[3 * j + c] = e;
        sum[c] = fmaf(w, e, sum[c]);
      }
    }
  }
#pragma unroll
  for (unsigned c = 0; c < 3; ++c) {
#pragma unroll
    for (int by = kGroup / 2; by > 0; by /= 2) sum[c] += __shfl_xor_sync(kAllLanes, sum[c], by);
  }
  if (!inside || threadIdx.x % kGroup != 0) return;
#pragma unroll
  for (unsigned c = 0; c < 3; ++c) {
    mean[(source * 3 + c) * patches + patch] = sum[c];
    if (!(fabsf(sum[c]) <= kLargestFloat)) *not_finite = 1;
  }
}

/// y[c][p] = (e[c][p] + Σ_q transport[c][p][q] · e[c][q]) · factor, one warp a row. Rows of the
/// transport are padded to `pitch`, a multiple of 4.
__global__ void exchange_patches(const float* transport, unsigned patches, unsigned pitch,
                                 const float* e, float factor, float* y);

}  // namespace relumbre::cuda
