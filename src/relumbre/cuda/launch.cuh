/// Starting kernels, and the shared memory that they get.
#pragma once

#include <cstddef>

#include <cuda_runtime.h>

#include "relumbre/cuda/error.h"
#include "relumbre/cuda/stream.h"

namespace relumbre::cuda {

struct Grid {
  dim3 blocks, threads;
  std::size_t shared_bytes = 0;  ///< of each block; see shared_as()
};

/// More than a kernel gets without asking.
inline constexpr std::size_t kPlainSharedBytes = std::size_t{48} << 10;

/// Starts a kernel in the stream; an empty grid is no work. Throws DeviceError.
template <class... Parameters, class... Arguments>
void launch(void (*kernel)(Parameters...), const Grid& grid, const Stream& stream,
            Arguments&&... arguments) {
  if (grid.blocks.x == 0 || grid.blocks.y == 0 || grid.blocks.z == 0) return;
  if (grid.shared_bytes > kPlainSharedBytes)
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(grid.shared_bytes)));
  kernel<<<grid.blocks, grid.threads, grid.shared_bytes, stream.get()>>>(
      static_cast<Parameters>(arguments)...);
  check(cudaGetLastError());
}

/// Blocks of a kernel that the current device runs at once.
template <class... Parameters>
int resident_blocks(void (*kernel)(Parameters...), unsigned threads, std::size_t shared_bytes = 0) {
  if (shared_bytes > kPlainSharedBytes)
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(shared_bytes)));
  int device = 0, multiprocessors = 0, blocks = 0;
  check(cudaGetDevice(&device));
  check(cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, device));
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, static_cast<int>(threads),
                                                      shared_bytes));
  return multiprocessors * (blocks > 0 ? blocks : 1);
}

/// The block's shared memory as a T, not initialised. Grid::shared_bytes must have room for it.
template <class T>
__device__ __forceinline__ T& shared_as() {
  extern __shared__ __align__(16) unsigned char relumbre_shared_memory[];
  return *reinterpret_cast<T*>(relumbre_shared_memory);
}

}  // namespace relumbre::cuda
