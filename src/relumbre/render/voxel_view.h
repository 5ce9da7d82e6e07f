/// Pictures of a sparse voxel octree.
#pragma once

#include <cstdint>

#include "relumbre/base/progress.h"
#include "relumbre/image/image.h"
#include "relumbre/octree/traverse.h"
#include "relumbre/octree/voxel_tree.h"
#include "relumbre/scene/camera.h"

namespace relumbre {

enum class VoxelShading {
  kLit,     ///< colour under a lamp at the eye and a uniform sky; grey where there are no colours
  kColor,   ///< colour as it is: what a tree of radiosity should be shown by
  kNormal,  ///< the normal, (n + 1) / 2 of each component
};

struct VoxelViewConfig {
  std::size_t width = 1280, height = 720;
  std::uint32_t samples = 4;  ///< rays a pixel, with a tent filter; 1: through its centre
  VoxelShading shading = VoxelShading::kLit;
  bool smooth = false;  ///< colours and normals interpolated between the voxels around a hit
  Rgb background{};
  std::uint64_t seed = 1;
};

/// The voxels as a camera sees them, with channels
///   R G B         by the shading
///   A             fraction of the pixel's samples that hit a voxel
///   Z             planar depth in metres, inf where nothing is hit
///   N.X N.Y N.Z   the voxel's normal, facing the camera; that of the face without values
/// The last two from the ray through the pixel's centre. Deterministic for any number of threads.
/// Throws ValueError for a camera or config out of range, Cancelled.
Image render_voxels(const VoxelTree& tree, const Camera& camera, const VoxelViewConfig& config = {},
                    Progress& progress = no_progress());

/// What one ray through each pixel's centre costs, by one of the thesis's traversals: channels
///   visits   nodes whose boxes were compared with the ray
///   reads    words of internal nodes that were fetched
///   level    of the deepest node that was visited
/// and R G B, a heat map of `shown` (one of the three names): from dark blue through red to white,
/// each pixel relative to the largest value. Throws as render_voxels().
Image traversal_heat_map(const VoxelTree& tree, const Camera& camera, std::size_t width,
                         std::size_t height, const Traversal& traversal, const std::string& shown,
                         Progress& progress = no_progress());

/// Looks at the cube from three quarters above, so that all of it is seen.
Camera voxel_camera(const VoxelTree& tree);

}  // namespace relumbre
