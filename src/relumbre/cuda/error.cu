#include <cstdio>

#include "relumbre/cuda/error.h"

namespace relumbre::cuda {

void check(cudaError_t status, std::source_location where) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // or it would be reported again by the next call
  const std::string file = where.file_name();
  throw DeviceError(file.substr(file.find_last_of('/') + 1) + ":" + std::to_string(where.line()) +
                    ": " + cudaGetErrorName(status) + ": " + cudaGetErrorString(status));
}

std::string in_gigabytes(std::size_t bytes) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f GB", static_cast<double>(bytes) * 1e-9);
  return text;
}

}  // namespace relumbre::cuda
