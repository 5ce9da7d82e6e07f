/// Where a tree's nodes lie, in bytes from its first leaf: one number names a node of any level.
#pragma once

#include <array>
#include <cstdint>

#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

class TreeAddresses {
 public:
  explicit TreeAddresses(const VoxelTree& tree)
      : base_(reinterpret_cast<const std::uint8_t*>(tree.leaves().data())) {
    for (unsigned level = 0; level + 1 < tree.levels(); ++level) {
      const auto* nodes = reinterpret_cast<const std::uint8_t*>(tree.nodes(level).data());
      first_[tree.levels() - 1 - level] =
          static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(nodes)) -
          static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(base_));
    }
  }

  [[nodiscard]] const std::uint8_t* base() const { return base_; }
  /// Of the first node at a height above the leaves, which is 0 theirs.
  [[nodiscard]] const std::int64_t* first() const { return first_.data(); }
  /// In its level, of the node at an address.
  [[nodiscard]] std::uint64_t index(std::int64_t address, unsigned height) const {
    const auto bytes = static_cast<std::uint64_t>(address - first_[height]);
    return bytes / (height == 0 ? sizeof(std::uint64_t) : sizeof(VoxelTree::Node));
  }

 private:
  const std::uint8_t* base_;
  std::array<std::int64_t, VoxelTree::kMaxLevels> first_{};
};

}  // namespace relumbre
