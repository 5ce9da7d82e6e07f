/// Pictures with depth on a GPU, and the fragments that they are made of.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "relumbre/base/host_device.h"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"
#include "relumbre/dof/circle_of_depth.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/dof/silhouette.h"

namespace relumbre::cuda {

/// A picture on the device. Those of one size are uploaded into the same memory.
class DevicePicture {
 public:
  /// Throws OutOfDeviceMemory.
  DevicePicture(std::size_t width, std::size_t height, bool behind);
  static std::size_t bytes_of(std::size_t pixels, bool behind);

  /// Asynchronous; `picture` stays as it is until the stream is waited for. Throws ShapeError for
  /// another size, and what DepthPicture::check() throws.
  void upload(const DepthPicture& picture, const Stream& stream);

  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  [[nodiscard]] std::size_t pixels() const { return width_ * height_; }
  [[nodiscard]] bool has_behind() const { return has_behind_; }
  /// Of what was uploaded last: DepthPicture::opaque(), and the depths between which all are.
  [[nodiscard]] bool opaque() const { return opaque_; }
  [[nodiscard]] float nearest() const { return nearest_; }
  [[nodiscard]] float farthest() const { return farthest_; }

  struct Layer {
    DeviceArray<Rgba> color;
    DeviceArray<float> depth;
  };
  [[nodiscard]] const Layer& front() const { return front_; }
  [[nodiscard]] const Layer& behind() const { return behind_; }  ///< if has_behind()

 private:
  std::size_t width_, height_;
  bool may_have_behind_, has_behind_ = false, opaque_ = true;
  float nearest_ = 0, farthest_ = 0;
  Layer front_, behind_;
};

/// A Fragment as kernels keep it: three reads of 16 bytes. Methods turn it into what they need,
/// which the words in brackets are for.
struct alignas(16) DeviceFragment {
  Rgba color;           ///< multiplied by the coverage [divided by a power of two; spread: and
                        ///< multiplied by the blur's share of a pixel]
  float coc;            ///< signed, pixels
  Vec2f slope;          ///< of the circle of confusion [spread: the blur's tilt]
  float coverage;       ///< of the pixel [spread: multiplied by the share]
  std::uint32_t x, y;   ///< pixel
  std::uint32_t layer;  ///< [its layer; layered: the nearer of the two]
};

/// Of all fragments. Floats are kept so that atomics on integers find the least of them: negative
/// ones with all bits turned over, others with the sign's alone.
struct FragmentSummary {
  std::uint32_t least, largest;
  std::uint32_t brightest;  ///< bits of the largest |colour| of any channel
  std::uint32_t count;

  [[nodiscard]] RELUMBRE_HOST_DEVICE float least_coc() const { return float_of(least); }
  [[nodiscard]] RELUMBRE_HOST_DEVICE float largest_coc() const { return float_of(largest); }
  static RELUMBRE_HOST_DEVICE std::uint32_t ordered(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
  }
  static RELUMBRE_HOST_DEVICE float float_of(std::uint32_t ordered) {
    return std::bit_cast<float>((ordered >> 31) != 0 ? ordered & 0x7FFFFFFFU : ~ordered);
  }
};

/// fragments_of() on the device: the same, but for their order. One for every pixel is at the
/// pixel's index, others come behind.
class DeviceFragments {
 public:
  /// Room for pictures of this size. Throws OutOfDeviceMemory.
  DeviceFragments(std::size_t pixels, bool behind);
  static std::size_t bytes_of(std::size_t pixels, bool behind);

  /// Asynchronous. About 85 bytes a pixel are moved. Where something lies behind, which of it a
  /// silhouette reveals is found in tiles, each in so many steps as three of its sides are long;
  /// for blurs that differ by more than 256 pixels in one for the whole picture. That takes up to
  /// 32 bytes a pixel more. Throws OutOfDeviceMemory.
  void find(const DevicePicture& picture, const CircleOfDepth& circle, const Stream& stream);

  [[nodiscard]] DeviceFragment* data() const { return fragments_.data(); }
  [[nodiscard]] const FragmentSummary* summary() const { return summary_.data(); }
  [[nodiscard]] const float* front_circles() const { return front_circles_.data(); }

 private:
  void reveal(const DevicePicture& picture, const CircleOfDepth& circle, const EdgeMap& edges,
              const Stream& stream);

  DeviceArray<DeviceFragment> fragments_;
  DeviceArray<FragmentSummary> summary_;
  DeviceArray<float> front_circles_, behind_circles_;
  DeviceArray<std::uint8_t> front_jumps_, behind_jumps_, mixed_, revealed_;
  DeviceArray<Silhouette> silhouettes_;  ///< of every tile's window
};

}  // namespace relumbre::cuda
