#include "relumbre/octree/tree_cast.h"

#include <algorithm>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/cast_kernels.h"
#include "relumbre/octree/tree_walk.h"

namespace relumbre {

TreeHit cast(const VoxelTree& tree, const CastRay& ray) {
  if (tree.leaves().empty()) return {};
  return TreeWalk(tree, ray).first_hit();
}

void cast(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits) {
  if (rays.size() != hits.size())
    throw ShapeError("cast: " + std::to_string(rays.size()) + " rays, " +
                     std::to_string(hits.size()) + " hits");
  if (tree.leaves().empty()) {
    std::ranges::fill(hits, TreeHit{});
    return;
  }
  constexpr std::size_t kGrain = 4096;
  parallel_chunks(0, rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    best_cast_kernel().cast(tree, rays.subspan(begin, end - begin),
                            hits.subspan(begin, end - begin));
  });
}

}  // namespace relumbre
