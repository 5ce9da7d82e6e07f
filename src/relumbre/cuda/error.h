/// What goes wrong on a GPU, as typed errors.
#pragma once

#include <cstddef>
#include <source_location>
#include <string>

#include <cuda_runtime_api.h>

#include "relumbre/base/error.h"

namespace relumbre::cuda {

/// The CUDA runtime or one of its libraries refused: "file:line: NAME: reason".
class DeviceError : public Error {
 public:
  using Error::Error;
};

/// Not enough memory on the device, with figures: what was asked and for what, what is free.
class OutOfDeviceMemory : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// Throws DeviceError unless the call succeeded.
void check(cudaError_t status, std::source_location where = std::source_location::current());

/// "1.50 GB": for messages.
std::string in_gigabytes(std::size_t bytes);

}  // namespace relumbre::cuda
