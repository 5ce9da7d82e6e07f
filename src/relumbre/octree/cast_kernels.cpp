#include "relumbre/octree/cast_kernels.h"

#include <algorithm>
#include <array>

#include "relumbre/octree/ray_queue.h"
#include "relumbre/octree/tree_walk.h"

// Members that are vectors need vectors of a known size.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relumbre/octree/cast_kernels.cpp"
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on
#include "relumbre/octree/ray_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

/// Rays that miss the cube are done; those that lanes cannot take are walked one by one.
void queue_rays(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits,
                RayQueue& queue) {
  const double edge = static_cast<double>(std::uint32_t{1} << tree.depth());
  queue.size = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const GridRay ray(rays[i].origin, rays[i].direction);
    const RayInterval cube = ray.interval({}, std::uint32_t{1} << tree.depth());
    const double end = std::min(rays[i].t_max, cube.exit);
    hits[i] = {};
    if (!(cube.enter < end)) continue;
    if (is_tame(ray, edge))
      push(queue, i, ray, rays[i].direction, cube.enter, end, edge);
    else
      hits[i] = TreeWalk(tree, ray).first_hit(0, rays[i].t_max);
  }
}

void cast_rays(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits) {
  const TreeAddresses addresses(tree);
  RayQueue queue;
  for (std::size_t i = 0; i < rays.size(); i += RayQueue::kCapacity) {
    const std::size_t count = std::min(RayQueue::kCapacity, rays.size() - i);
    queue_rays(tree, rays.subspan(i, count), hits.subspan(i, count), queue);
    cast_queue(tree, addresses, queue, rays.subspan(i, count), hits.subspan(i, count));
  }
}

CastKernel kernel() { return {hwy::TargetName(HWY_TARGET), cast_rays}; }

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "relumbre/base/instruction_sets-inl.h"

namespace relumbre {

HWY_EXPORT(kernel);

const CastKernel& best_cast_kernel() {
  static const CastKernel best = HWY_DYNAMIC_DISPATCH(kernel)();
  return best;
}

std::vector<CastKernel> available_cast_kernels() {
  return on_every_instruction_set([] { return HWY_DYNAMIC_DISPATCH(kernel)(); });
}

}  // namespace relumbre
#endif  // HWY_ONCE
