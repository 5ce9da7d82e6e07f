/// Depth of field on a GPU: the ladder of methods behind one call.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"
#include "relumbre/dof/depth_of_field.h"
#include "relumbre/dof/fragments_cuda.h"
#include "relumbre/dof/gather_cuda.h"
#include "relumbre/dof/layered_cuda.h"
#include "relumbre/dof/spread_cuda.h"

namespace relumbre::cuda {

/// Depth of field of pictures of one size, of which any number can be computed: memory on the
/// device is allocated for the method that is first asked for and kept. Not for several threads at
/// once.
class DeviceDof {
 public:
  /// `behind`: pictures may say what lies behind their front. Throws ShapeError for no pixels.
  DeviceDof(std::size_t width, std::size_t height, bool behind);

  /// To the device; waits until it is there. Throws ShapeError for another size, what
  /// DepthPicture::check() throws, OutOfDeviceMemory with figures before anything is allocated.
  void upload(const DepthPicture& picture);

  /// Of the picture uploaded last, as depth_of_field() with the same fields. Asynchronous, except
  /// when a method is asked for anew or with an aperture or largest blur it had not. Throws what
  /// ThinLens::check() throws, ValueError for what the methods do, OutOfDeviceMemory; and
  /// ValueError for infill of a picture that does not say what lies behind: that is made by
  /// infilled() before the upload.
  void run(const DofConfig& config);

  /// Premultiplied colours; waits for them.
  [[nodiscard]] std::vector<Rgba> download() const;

  /// In which everything happens: to time it, or to wait for it.
  [[nodiscard]] const Stream& stream() const { return stream_; }
  [[nodiscard]] const Rgba* result() const { return result_.data(); }

 private:
  template <class Method, class... Arguments>
  static Method& made(std::optional<Method>& method, std::size_t bytes, Arguments... arguments);
  DeviceFragments& fragments();

  std::size_t width_, height_;
  bool behind_;
  Stream stream_;
  std::optional<DevicePicture> picture_;
  DeviceArray<Rgba> result_;
  std::optional<DeviceFragments> fragments_;
  std::optional<DeviceGather> gather_;
  std::optional<DeviceLayered> layered_;
  std::optional<DeviceSpread> spread_;
};

/// depth_of_field() on the calling thread's device: the same arguments, errors and result, within
/// rounding (see the methods). What lies behind is guessed on the CPU, where that is asked for.
/// Throws also DeviceError, OutOfDeviceMemory.
std::vector<Rgba> depth_of_field(const DepthPicture& picture, const DofConfig& config);

}  // namespace relumbre::cuda
