/// The octree that users render with: 4 × 4 × 4 children a node, two octree levels at once.
///
///   level 0            one node: the cube (for an odd depth the lower half of its children, an
///     ...              octant of eight, are all it has)
///   level n - 2        inner nodes { mask of children, index of the first one in the next level }
///   level n - 1        leaves: a mask of voxels each                 n = ⌈depth / 2⌉, at least 1
///
/// Children and voxels are in the order of their Morton codes, and only those that exist are
/// stored: a child's index is the first one's plus the count of the mask's bits below its own. A
/// surface takes about half a byte a voxel. Values, if there are any, have one entry a voxel, and
/// one a node: the mean of all voxels under it, for views from afar.
///
/// A tree is a view of memory that it shares, its own or a mapped file's: copies are cheap.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "relumbre/base/host_device.h"
#include "relumbre/octree/cube.h"
#include "relumbre/octree/morton.h"
#include "relumbre/octree/separating.h"
#include "relumbre/octree/voxel_value.h"

namespace relumbre {

class VoxelTree {
 public:
  static constexpr unsigned kMaxLevels = 8;  ///< of nodes

  /// What the voxels' colours are.
  enum class Content { kReflectance, kRadiosity };

  struct Node {
    std::uint64_t mask = 0;
    std::uint64_t first = 0;  ///< of the children, in the next level
  };
  /// A node below the root or a voxel: that of the bit of a node's mask.
  struct Child {
    std::uint64_t parent = 0;  ///< its index in its level
    unsigned bit = 0;
    unsigned level = 0;  ///< the parent's; if it is that of the leaves, this is a voxel
    friend bool operator==(const Child&, const Child&) = default;
  };
  /// What a tree is made of; spans may be of anything that `owner` keeps.
  struct Parts {
    Cube cube;
    unsigned depth = 0;
    Separating separating = Separating::k26;
    Content content = Content::kReflectance;
    std::array<std::span<const Node>, kMaxLevels> nodes;  ///< of the inner levels
    std::span<const std::uint64_t> leaves;
    std::span<const std::uint64_t> first_voxel;  ///< of each leaf; empty without values
    std::span<const VoxelValue> values;
    std::array<std::span<const VoxelValue>, kMaxLevels> node_values;  ///< of all levels
    std::shared_ptr<const void> owner;
  };

  VoxelTree() = default;
  /// Only parts that belong together: see check_tree().
  explicit VoxelTree(Parts parts) : parts_(std::move(parts)) {}

  [[nodiscard]] const Cube& cube() const { return parts_.cube; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE unsigned depth() const { return parts_.depth; }
  [[nodiscard]] Separating separating() const { return parts_.separating; }
  [[nodiscard]] Content content() const { return parts_.content; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE unsigned levels() const { return levels_of(parts_.depth); }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::span<const Node> nodes(unsigned level) const {
    return parts_.nodes[level];
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::span<const std::uint64_t> leaves() const {
    return parts_.leaves;
  }
  [[nodiscard]] bool has_values() const { return !parts_.values.empty(); }
  [[nodiscard]] std::span<const VoxelValue> values() const { return parts_.values; }
  [[nodiscard]] std::span<const VoxelValue> node_values(unsigned level) const {
    return parts_.node_values[level];
  }
  [[nodiscard]] const Parts& parts() const { return parts_; }

  /// Nodes of a level, leaves included.
  [[nodiscard]] std::size_t size(unsigned level) const {
    return level + 1 == levels() ? parts_.leaves.size() : parts_.nodes[level].size();
  }
  [[nodiscard]] std::uint64_t voxels() const;
  /// Of the masks and indices, without values.
  [[nodiscard]] std::uint64_t geometry_bytes() const;
  /// Voxels an edge of the children of a level's nodes; 1 of those of leaves.
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::uint32_t child_edge(unsigned level) const {
    return std::uint32_t{1} << 2 * (levels() - 1 - level);
  }

  /// The voxel of a cell, or the child of some level's node that the cell is in; none if there is
  /// none, or outside the grid.
  [[nodiscard]] std::optional<Child> find(const Cell& cell) const {
    return find(cell, levels() - 1);
  }
  [[nodiscard]] std::optional<Child> find(const Cell& cell, unsigned level) const;

  /// What it looks like, or the mean of what is below it. Only of a tree with values.
  [[nodiscard]] const VoxelValue& value(const Child& child) const;

  /// How many bits of the mask are set below `bit`.
  RELUMBRE_HOST_DEVICE static std::uint64_t rank(std::uint64_t mask, unsigned bit) {
    return static_cast<std::uint64_t>(std::popcount(mask & ((std::uint64_t{1} << bit) - 1)));
  }
  static constexpr unsigned levels_of(unsigned depth) { return depth < 2 ? 1 : (depth + 1) / 2; }

 private:
  Parts parts_;
};

/// The voxels' Morton codes, ascending: what an Octree is built from.
std::vector<std::uint64_t> voxel_codes(const VoxelTree& tree);

/// Throws ShapeError where a tree's parts do not belong together: counts, indices, empty masks,
/// voxels outside the grid. Reads all of the tree but its values.
void check_tree(const VoxelTree& tree);

/// Calls visit(Morton code, index) for every voxel, in ascending order of both.
template <class Visit>
void for_each_voxel(const VoxelTree& tree, Visit&& visit) {
  std::uint64_t index = 0;
  const auto descend = [&](const auto& self, unsigned level, std::uint64_t node,
                           std::uint64_t code) -> void {
    const bool is_leaf = level + 1 == tree.levels();
    std::uint64_t mask = is_leaf ? tree.leaves()[node] : tree.nodes(level)[node].mask;
    std::uint64_t child = is_leaf ? 0 : tree.nodes(level)[node].first;
    for (; mask != 0; mask &= mask - 1) {
      const std::uint64_t below = code << 6 | static_cast<unsigned>(std::countr_zero(mask));
      if (is_leaf)
        visit(below, index++);
      else
        self(self, level + 1, child++, below);
    }
  };
  descend(descend, 0, 0, 0);
}

}  // namespace relumbre
