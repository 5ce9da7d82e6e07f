#include "relumbre/experiment/word_scene.h"

#include <string>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/octree/voxelize.h"

namespace relumbre {

namespace {

int checked_depth(unsigned depth) {
  if (depth == 0 || depth > kMaxWordDepth)
    throw ValueError("the simulated machine needs a depth of 1 to " +
                     std::to_string(kMaxWordDepth) + ", not " + std::to_string(depth));
  return static_cast<int>(depth);
}

}  // namespace

WordScene word_scene(const TriangleMesh& mesh, unsigned depth, Separating separating,
                     Progress& progress) {
  const int levels = checked_depth(depth);
  const Cube cube = cube_around(bounds(mesh.positions));
  VoxelizeConfig config{.depth = depth, .separating = separating, .surface = {}};
  return {cube, Octree(voxel_codes(voxelize(mesh, cube, config, progress)), levels)};
}

WordScene word_scene(const VoxelTree& tree) {
  const int levels = checked_depth(tree.depth());
  return {tree.cube(), Octree(voxel_codes(tree), levels)};
}

}  // namespace relumbre
