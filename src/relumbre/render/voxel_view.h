/// Pictures of a sparse voxel octree.
#pragma once

#include <cstdint>
#include <optional>

#include "relumbre/base/progress.h"
#include "relumbre/image/image.h"
#include "relumbre/octree/traverse.h"
#include "relumbre/octree/voxel_tree.h"
#include "relumbre/render/voxel_shader.h"
#include "relumbre/scene/camera.h"

namespace relumbre {

struct VoxelViewConfig {
  std::size_t width = 1280, height = 720;
  std::uint32_t samples = 4;  ///< rays a pixel, with a tent filter; 1: through its centre
  VoxelShading shading = VoxelShading::kLit;
  bool smooth = false;  ///< colours and normals interpolated between the voxels around a hit
  double detail = 0;    ///< nodes of up to so many pixels are shown by their means; 0: voxels alone
  TreeCaster caster;    ///< who casts the rays; empty: the CPU
  std::optional<Traversal> traversal;  ///< of the architectural octree; none: the fast one
  Rgb background{};
  std::uint64_t seed = 1;
};

/// The voxels as a camera sees them, with channels
///   R G B         by the shading
///   A             fraction of the pixel's samples that hit a voxel
///   Z             planar depth in metres, inf where nothing is hit
///   N.X N.Y N.Z   the voxel's normal, facing the camera; that of the face without values
/// The last two from the ray through the pixel's centre. Deterministic for any number of threads,
/// and the same for every traversal. Throws ValueError for a camera or config out of range, or for
/// level of detail or a caster with one of the thesis's traversals, which know voxels alone;
/// Cancelled.
Image render_voxels(const VoxelTree& tree, const Camera& camera, const VoxelViewConfig& config = {},
                    Progress& progress = no_progress());

/// Looks at the cube from three quarters above, so that all of it is seen.
Camera voxel_camera(const Cube& cube);

}  // namespace relumbre
