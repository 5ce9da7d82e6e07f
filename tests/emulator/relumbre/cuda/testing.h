/// Stands in for src/relumbre/cuda/testing.h.
#pragma once

#include <cuda_runtime_api.h>

#include "relumbre/cuda/device.h"

#define RELUMBRE_NEEDS_DEVICE() \
  if (relumbre::cuda::devices().empty()) GTEST_SKIP() << "no CUDA device"

namespace relumbre::cuda {
inline bool pretend_memory(std::size_t bytes) {
  emulator::set_device_bytes(bytes);
  return true;
}
}  // namespace relumbre::cuda
