/// Depth of field by layers, on a GPU.
#pragma once

#include <cstddef>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"
#include "relumbre/dof/fragments_cuda.h"
#include "relumbre/dof/layered.h"
#include "relumbre/dof/sort_fragments_cuda.h"

namespace relumbre::cuda {

/// layered() on the device, of pictures of one size. A box blurs all that lies on a step alike, so
/// it makes no difference whether the step's picture is blurred as a whole or each fragment is
/// spread over its box: here they are, by the tiles of DeviceSpread, in both steps between which
/// they lie. So no step's picture is ever in device memory, and steps that do not reach a tile cost
/// it nothing. The same in every run; differs from the CPU's by rounding.
class DeviceLayered {
 public:
  /// Throws OutOfDeviceMemory.
  DeviceLayered(std::size_t pixels, bool behind) : sorter_(pixels, behind, 2) {}
  static std::size_t bytes_of(std::size_t pixels, bool behind) {
    return FragmentSorter::bytes_of(pixels, behind, 2);
  }

  /// Waits once, for the least and the largest circle of confusion: the steps depend on them.
  /// `result`: a colour a pixel, on the device. Fragments are consumed. Throws ValueError for what
  /// layered() throws it and for blurs of more than ApertureKernels::kLargest; OutOfDeviceMemory.
  void run(const DevicePicture& picture, DeviceFragments& fragments, const ThinLens& lens,
           const LayeredConfig& config, Rgba* result, const Stream& stream);

 private:
  FragmentSorter sorter_;
  DeviceArray<float> steps_;  ///< signed diameters, then the radii of their boxes
};

}  // namespace relumbre::cuda
