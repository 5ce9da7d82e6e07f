/// Scenes as voxels, for benchmarks.
#pragma once

#include "relumbre/octree/voxel_tree.h"
#include "relumbre/octree/voxelize.h"
#include "relumbre/scene/camera.h"
#include "relumbre/scene/scene.h"

namespace relumbre::bench {

/// From triangles to the finished tree; conservative, without colours, unless told otherwise.
VoxelTree build_voxels(const Scene& scene, const VoxelizeConfig& config);

/// The automatic camera, nearer: that one leaves most of the picture empty.
Camera near_camera(const Scene& scene);

}  // namespace relumbre::bench
