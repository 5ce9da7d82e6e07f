/// Something to cast rays at that needs no file.
#pragma once

#include "relumbre/octree/voxel_tree.h"

namespace relumbre::bench {

/// Voxels of a ball with bumps of several sizes, about as wrinkled as a scan.
VoxelTree bumpy_ball(unsigned depth);

}  // namespace relumbre::bench
