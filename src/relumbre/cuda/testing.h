/// For tests that need a GPU.
#pragma once

#include "relumbre/cuda/device.h"

/// Skips the test that it begins where there is no device.
#define RELUMBRE_NEEDS_DEVICE() \
  if (relumbre::cuda::devices().empty()) GTEST_SKIP() << "no CUDA device"
