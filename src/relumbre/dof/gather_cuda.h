/// Depth of field by gathering, on a GPU.
#pragma once

#include <cstddef>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"
#include "relumbre/dof/fragments_cuda.h"
#include "relumbre/sat/sat_cuda.h"

namespace relumbre::cuda {

/// gather() on the device, of pictures of one size: one summed-area table of doubles, of which
/// every pixel reads its box. Results differ from the CPU's by the tables' rounding.
class DeviceGather {
 public:
  /// Throws OutOfDeviceMemory.
  DeviceGather(std::size_t width, std::size_t height);
  static std::size_t bytes_of(std::size_t pixels);

  /// Asynchronous. `result`: a colour a pixel, on the device. Throws ValueError for a lens or a
  /// largest diameter for which gather() throws it.
  void run(const DevicePicture& picture, const ThinLens& lens, double largest_diameter,
           Rgba* result, const Stream& stream);

 private:
  DeviceSat table_;
  DeviceArray<float> radii_;
};

}  // namespace relumbre::cuda
