/// The fast traversal: the first voxel of a VoxelTree that a ray pierces.
///
/// Exact: for every ray the hit is that of grid_ray.h, bit for bit, as the slow traversals find it.
/// Rays are in grid coordinates; Cube::to_voxels() has them.
///
/// Level of detail: for a ray that widens, the root's descendants that are no larger than its
/// footprint where it enters them count as voxels, whatever is in them. The hit is the first of
/// those and of the voxels, as exactly.
///
///   one ray      a walk with a stack of nodes
///   many rays    first as beams of 64 neighbours, where they go the same way, then one ray a lane
///                of the processor's vectors, on all threads
///
/// Rays go from one empty block to the next, a block being a node's child or eight of them that
/// are all empty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "relumbre/octree/grid_ray.h"
#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

/// A ray of a batch.
struct CastRay {
  Vec3d origin, direction;
  double t_max =
      std::numeric_limits<double>::infinity();  ///< what is entered from here on isn't hit
  double spread = 0;  ///< its footprint is spread · t voxels wide; 0: voxels alone are hit
};

/// What was hit, and where the tree has it: a voxel, or a node for a ray that widens.
struct TreeHit {
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  VoxelHit voxel;  ///< the cell of a node is its lower corner
  VoxelTree::Child child{kNone, 0, 0};
  RELUMBRE_HOST_DEVICE explicit operator bool() const { return child.parent != kNone; }
  friend bool operator==(const TreeHit&, const TreeHit&) = default;
};

/// One ray. A default tree, without any node, is never hit.
TreeHit cast(const VoxelTree& tree, const CastRay& ray);

/// hits[i] = cast(tree, rays[i]), on all threads. Fastest where neighbours in the array go much the
/// same way. Throws ShapeError if the sizes differ.
void cast(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits);

/// Another who casts a batch through some tree, such as a GPU.
using TreeCaster = std::function<void(std::span<const CastRay>, std::span<TreeHit>)>;

}  // namespace relumbre
