#include "relumbre/octree/tree_cast.h"

#include <string>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/tree_walk.h"

namespace relumbre {

TreeHit cast(const VoxelTree& tree, const GridRay& ray, double t_max) {
  if (tree.leaves().empty()) return {};
  return TreeWalk(tree, ray).first_hit(0, t_max);
}

void cast(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits) {
  if (rays.size() != hits.size())
    throw ShapeError("cast: " + std::to_string(rays.size()) + " rays, " +
                     std::to_string(hits.size()) + " hits");
  constexpr std::size_t kGrain = 4096;
  parallel_for(0, rays.size(), kGrain, [&](std::size_t i) {
    hits[i] = cast(tree, GridRay(rays[i].origin, rays[i].direction), rays[i].t_max);
  });
}

}  // namespace relumbre
