/// Builds a VoxelTree from blocks of voxels as they come.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "relumbre/octree/voxel_blocks.h"
#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

/// Takes voxels' values, as many at a time as a call of add() brings.
using ValueSink = std::function<void(std::span<const VoxelValue>)>;

class VoxelTreeBuilder {
 public:
  /// With `values`, the voxels' values go there instead of into the tree: they are most of what a
  /// tree takes.
  VoxelTreeBuilder(const Cube& cube, unsigned depth, Separating separating, ValueSink values = {});

  /// Blocks behind all that came before. Throws ValueError if they aren't, if one is empty or
  /// outside the grid, or if some have values and others do not.
  void add(const VoxelBlocks& blocks);

  /// Nothing follows. The tree has no values(), but everything that belongs to them, where they
  /// went to a sink. Throws ValueError if there were no voxels.
  VoxelTree finish();

 private:
  /// A level's node that is still open, and all that are closed.
  struct Level {
    std::uint64_t code = 0, mask = 0;
    VoxelMean mean;  ///< of all voxels under it
    std::vector<VoxelTree::Node> nodes;
    std::vector<VoxelValue> values;
  };
  void add_leaf(std::uint64_t code, std::uint64_t mask, const VoxelMean& mean);
  void add_child(std::size_t level, std::uint64_t code, const VoxelMean& mean);
  void close(std::size_t level);

  Cube cube_;
  unsigned depth_;
  Separating separating_;
  ValueSink sink_;
  bool has_values_ = false;
  std::vector<Level> inner_;
  std::vector<std::uint64_t> leaves_;
  std::vector<VoxelValue> leaf_values_, values_;
  std::uint64_t next_code_ = 0;
};

/// Of all voxels at once.
VoxelTree build_tree(const Cube& cube, unsigned depth, Separating separating,
                     const VoxelBlocks& blocks);

}  // namespace relumbre
