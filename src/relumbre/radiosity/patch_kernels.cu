#include <algorithm>

#include "relumbre/radiosity/count_product.cuh"
#include "relumbre/radiosity/patch_kernels.cuh"

namespace relumbre::cuda {

__global__ void exchange_patches(const float* transport, unsigned patches, unsigned pitch,
                                 const float* e, float factor, float* y) {
  const unsigned row = (blockIdx.x * kPatchThreads + threadIdx.x) / kWarp,
                 lane = threadIdx.x % kWarp;
  if (row >= 3 * patches) return;
  const float* from = e + row / patches * patches;
  const auto* fours = reinterpret_cast<const float4*>(transport + std::size_t{row} * pitch);
  float sum = 0;
#pragma unroll 4
  for (unsigned q = lane; q < patches / 4; q += kWarp) {
    const float4 m = __ldg(fours + q);
    sum = fmaf(m.x, from[4 * q], sum);
    sum = fmaf(m.y, from[4 * q + 1], sum);
    sum = fmaf(m.z, from[4 * q + 2], sum);
    sum = fmaf(m.w, from[4 * q + 3], sum);
  }
  const unsigned rest = patches / 4 * 4 + lane;
  if (rest < patches) sum = fmaf(transport[std::size_t{row} * pitch + rest], from[rest], sum);
  sum = warp_sum(sum);
  if (lane == 0) y[row] = (from[row % patches] + sum) * factor;
}

namespace {

struct Maxima {
  float of_warp[kPatchThreads / kWarp];
};

}  // namespace

__global__ void split_vectors(const float* vectors, unsigned count, unsigned columns,
                              unsigned padded, __half* operand, float* unscale) {
  auto& maxima = shared_as<Maxima>();
  const unsigned vector = blockIdx.x;
  const float* from = vectors + std::size_t{vector} * columns;
  const unsigned given = vector < count ? columns : 0;
  float largest = 0;
  for (unsigned p = threadIdx.x; p < given; p += kPatchThreads)
    largest = fmaxf(largest, fabsf(from[p]));
#pragma unroll
  for (int by = 16; by > 0; by /= 2)
    largest = fmaxf(largest, __shfl_xor_sync(kAllLanes, largest, by));
  if (threadIdx.x % kWarp == 0) maxima.of_warp[threadIdx.x / kWarp] = largest;
  __syncthreads();
#pragma unroll
  for (unsigned w = 0; w < kPatchThreads / kWarp; ++w) largest = fmaxf(largest, maxima.of_warp[w]);

  int exponent = 14;
  if (largest > 0 && largest < 3e38F) frexpf(largest, &exponent);
  const int shift = std::min(14 - exponent, 100);
  const float scale = ldexpf(1.0F, shift);
  __half* high = operand + std::size_t{2 * vector} * padded;
  __half* low = high + padded;
  for (unsigned p = threadIdx.x; p < padded; p += kPatchThreads) {
    const float value = p < given ? from[p] * scale : 0.0F;
    const __half first = __float2half_rn(value);
    high[p] = first;
    low[p] = __float2half_rn((value - __half2float(first)) * kLowScale);
  }
  if (threadIdx.x == 0) unscale[vector] = ldexpf(1.0F, -shift);
}

}  // namespace relumbre::cuda
