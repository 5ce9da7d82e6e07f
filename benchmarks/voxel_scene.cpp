#include "voxel_scene.h"

#include "relumbre/octree/voxel_tree_builder.h"

namespace relumbre::bench {

VoxelTree build_voxels(const Scene& scene, const VoxelizeConfig& config) {
  const Cube cube = cube_around(bounds(scene.mesh.positions));
  VoxelTreeBuilder builder(cube, config.depth, config.separating);
  voxelize(scene.mesh, cube, config, [&](VoxelBlocks&& blocks) { builder.add(blocks); });
  return builder.finish();
}

Camera near_camera(const Scene& scene) {
  Camera camera = auto_camera(scene);
  camera.eye = camera.target + (camera.eye - camera.target) * 0.45F;
  return camera;
}

}  // namespace relumbre::bench
