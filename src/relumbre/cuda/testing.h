/// For tests that need a GPU.
#pragma once

#include "relumbre/cuda/device.h"

/// Skips the test that it begins where there is no device.
#define RELUMBRE_NEEDS_DEVICE() \
  if (relumbre::cuda::devices().empty()) GTEST_SKIP() << "no CUDA device"

namespace relumbre::cuda {
/// Makes the emulator's device one of so much memory in all; false on a real one, which has what it
/// has.
inline bool pretend_memory(std::size_t) { return false; }
}  // namespace relumbre::cuda
