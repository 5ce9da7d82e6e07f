/// Depth of field by spreading, on a GPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"
#include "relumbre/dof/aperture_kernel.h"
#include "relumbre/dof/sort_fragments_cuda.h"
#include "relumbre/dof/spread.h"

namespace relumbre::cuda {

/// An ApertureKernel in a table of them.
struct KernelHead {
  int top, bottom, reach;
  std::uint32_t first;  ///< of its spans
  double share;
};

/// spread() on the device, of pictures of one size, with memory that it keeps.
///
/// Fragments are sorted by layer and cell. Then every block takes a tile of the picture and goes
/// through the layers from front to back: it writes the steps of all blurs that reach the tile into
/// sums in shared memory, adds them up, and lays the layer behind what is there, in registers. The
/// layers' sums are never in device memory.
///
/// Sums are of 64-bit fixed point, so that results do not depend on the order in which threads
/// come, and are the same in every run. They differ from the CPU's by rounding (1e-5 of the
/// brightness around at most), except for polygons whose blurs the CPU spreads along their edges:
/// SkewedSums makes slanted edges up to a pixel softer, this one never does.
class DeviceSpread {
 public:
  /// Throws OutOfDeviceMemory.
  DeviceSpread(std::size_t pixels, bool behind) : sorter_(pixels, behind, 1) {}
  static std::size_t bytes_of(std::size_t pixels, bool behind) {
    return FragmentSorter::bytes_of(pixels, behind, 1);
  }

  /// Asynchronous, but for kernels of another aperture or a larger blur than before, which are made
  /// and copied first. `result`: a colour a pixel, on the device. Fragments are consumed. Throws
  /// ValueError for what spread() throws it, OutOfDeviceMemory.
  void run(const DevicePicture& picture, DeviceFragments& fragments, const ThinLens& lens,
           const SpreadConfig& config, Rgba* result, const Stream& stream);

 private:
  /// Of one aperture, up to one diameter.
  struct Kernels {
    BlurShape shape;
    Aperture aperture;
    double largest;
    std::uint32_t count;  ///< of either side
    DeviceArray<KernelHead> heads;
    DeviceArray<ApertureKernel::Span> spans;
  };
  void make_kernels(const SpreadConfig& config, double largest, const Stream& stream);
  FragmentSorter sorter_;
  std::optional<Kernels> kernels_;
};

}  // namespace relumbre::cuda
