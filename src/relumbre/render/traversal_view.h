/// Pictures of what a traversal of an octree costs.
#pragma once

#include <string>

#include "relumbre/base/progress.h"
#include "relumbre/image/image.h"
#include "relumbre/octree/traverse.h"
#include "relumbre/octree/voxel_tree.h"
#include "relumbre/scene/camera.h"

namespace relumbre {

/// What one ray through each pixel's centre costs, by one of the thesis's traversals: channels
///   visits   nodes whose boxes were compared with the ray
///   reads    words of internal nodes that were fetched
///   level    of the deepest node that was visited
/// and R G B, a heat map of `shown` (one of the three names): from dark blue through red to white,
/// each pixel relative to the largest value. Throws as render_voxels().
Image traversal_heat_map(const VoxelTree& tree, const Camera& camera, std::size_t width,
                         std::size_t height, const Traversal& traversal, const std::string& shown,
                         Progress& progress = no_progress());

}  // namespace relumbre
