/// What the simulated machine casts rays at: an octree of words, and where it is in the world.
#pragma once

#include "relumbre/base/progress.h"
#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/octree/cube.h"
#include "relumbre/octree/octree.h"
#include "relumbre/octree/triangle_cells.h"
#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

struct WordScene {
  Cube cube;
  Octree octree;
};

/// Deeper octrees have codes of more than the machine's traces can hold in memory anyway.
inline constexpr unsigned kMaxWordDepth = 13;

/// A mesh's voxels. 8 bytes a voxel meanwhile. Throws ValueError for a depth of 0 or beyond
/// kMaxWordDepth, for a mesh without extent or that is not finite; Cancelled.
WordScene word_scene(const TriangleMesh& mesh, unsigned depth, Separating separating,
                     Progress& progress = no_progress());

/// The voxels of the tree that users render with. Throws ValueError as above.
WordScene word_scene(const VoxelTree& tree);

}  // namespace relumbre
