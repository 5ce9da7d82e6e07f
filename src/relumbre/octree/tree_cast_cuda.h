/// The fast traversal on a GPU: the same hits, bit for bit.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "relumbre/cuda/memory.h"
#include "relumbre/octree/tree_cast.h"

namespace relumbre::cuda {

/// A VoxelTree's masks and indices on the device that is current in the constructor, about half a
/// byte a voxel. Values stay behind: hits say where they are. Movable. One call at a time.
class DeviceTree {
 public:
  /// Throws OutOfDeviceMemory with figures.
  explicit DeviceTree(const VoxelTree& tree);
  ~DeviceTree();
  DeviceTree(DeviceTree&&) noexcept;
  DeviceTree& operator=(DeviceTree&&) noexcept;

  [[nodiscard]] static std::size_t device_bytes(const VoxelTree& tree);

  /// hits[i] = cast(tree, rays[i]), any number of them, through page-locked buffers: while some are
  /// cast, others travel. Throws ShapeError if the sizes differ, OutOfDeviceMemory.
  void cast(std::span<const CastRay> rays, std::span<TreeHit> hits) const;

  /// The same of arrays on the device, asynchronous. Rays of a picture of this width are cast in
  /// tiles of 8 × 4 pixels; 0: in their order.
  void cast(const CastRay* rays, TreeHit* hits, std::size_t count, std::size_t width,
            const Stream& stream) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace relumbre::cuda
