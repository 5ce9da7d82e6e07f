/// A Bvh on a device.
#pragma once

#include <cstddef>
#include <span>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"
#include "relumbre/visibility/bvh.h"
#include "relumbre/visibility/bvh_traverse.h"

namespace relumbre::cuda {

/// A copy in the memory of the current device, Bvh::bytes() long.
class DeviceBvh {
 public:
  DeviceBvh(const Bvh& bvh, const Stream& stream)
      : nodes_(to_device(std::span(bvh.nodes), stream)),
        triangles_(to_device(std::span(bvh.triangles), stream)) {}

  /// For kernels.
  [[nodiscard]] BvhView view() const { return {nodes_.data(), triangles_.data()}; }
  [[nodiscard]] std::size_t bytes() const { return nodes_.bytes() + triangles_.bytes(); }

 private:
  DeviceArray<BvhNode> nodes_;
  DeviceArray<BvhTriangle> triangles_;
};

}  // namespace relumbre::cuda
