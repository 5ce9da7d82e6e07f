#include "relumbre/cuda/memory.h"

namespace relumbre::cuda::detail {

void* allocate_device(std::size_t bytes) {
  void* memory = nullptr;
  const cudaError_t status = cudaMalloc(&memory, bytes);
  if (status == cudaErrorMemoryAllocation) {
    cudaGetLastError();
    std::size_t free = 0, total = 0;
    check(cudaMemGetInfo(&free, &total));
    throw OutOfDeviceMemory("out of device memory: " + in_gigabytes(bytes) + " asked, " +
                            in_gigabytes(free) + " of " + in_gigabytes(total) + " are free");
  }
  check(status);
  return memory;
}

void* allocate_pinned(std::size_t bytes) {
  void* memory = nullptr;
  check(cudaHostAlloc(&memory, bytes, cudaHostAllocDefault));
  return memory;
}

}  // namespace relumbre::cuda::detail
