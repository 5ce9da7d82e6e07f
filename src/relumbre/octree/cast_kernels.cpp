#include "relumbre/octree/cast_kernels.h"

#include <algorithm>
#include <array>
#include <bit>

#include "relumbre/octree/tree_beam.h"
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

/// Rays in groups; each group's rays start together where their beam does.
class Batch {
 public:
  Batch(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits)
      : tree_(tree),
        edge_(std::uint32_t{1} << tree.depth()),
        rays_(rays),
        hits_(hits),
        addresses_(tree),
        lanes_{{tree, addresses_}, {tree, addresses_}} {}

  /// Two sets of lanes by turns: while one waits for its nodes, the other has something to do.
  void cast() {
    for (;;) {
      for (RayLanes& lanes : lanes_) refill(lanes);
      if (!lanes_[0].any() && !lanes_[1].any()) return;
      for (RayLanes& lanes : lanes_) lanes.advance();
    }
  }

 private:
  static constexpr std::size_t kGroup = 64;

  void refill(RayLanes& lanes) {
    for (unsigned free = lanes.free(); free != 0; free &= free - 1) {
      while (next_ == group_size_ && first_ < rays_.size()) prepare_group();
      if (next_ == group_size_) return;
      const std::size_t i = index_[next_];
      const auto lane = static_cast<std::size_t>(std::countr_zero(free));
      lanes.start(lane, rays_[i], hits_[i], group_[next_]);
      ++next_;
    }
  }

  void prepare_group() {
    const std::size_t end = std::min(first_ + kGroup, rays_.size());
    group_size_ = next_ = 0;
    for (; first_ < end; ++first_) prepare(first_);
    if (group_size_ < kGroup / 4) return;
    const TreeBeam beam(tree_, std::span(group_).first(group_size_));
    if (beam.is_beam()) start_later(beam);
  }

  /// Rays that miss the cube are done; those that lanes cannot take are walked.
  void prepare(std::size_t i) {
    const GridRay ray(rays_[i].origin, rays_[i].direction);
    const RayInterval cube = ray.interval({}, edge_);
    const double end = std::min(rays_[i].t_max, cube.exit);
    hits_[i] = {};
    if (!(cube.enter < end)) return;
    if (!is_tame(ray, edge_)) {
      hits_[i] = TreeWalk(tree_, rays_[i]).first_hit();
      return;
    }
    index_[group_size_] = i;
    group_[group_size_++] = {ray, rays_[i].direction, cube.enter, end, rays_[i].spread};
  }

  void start_later(const TreeBeam& beam) {
    const double plane = beam.first_plane();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < group_size_; ++i) {
      CubeRay ray = group_[i];
      ray.now = std::max(ray.now, beam.time(ray.ray, plane));
      if (!(ray.now < ray.end)) continue;
      index_[kept] = index_[i];
      group_[kept++] = ray;
    }
    group_size_ = kept;
  }

  const VoxelTree& tree_;
  std::uint32_t edge_;
  std::span<const CastRay> rays_;
  std::span<TreeHit> hits_;
  std::size_t first_ = 0;  ///< that no group has had
  std::array<CubeRay, kGroup> group_;
  std::array<std::size_t, kGroup> index_{};
  std::size_t group_size_ = 0, next_ = 0;
  TreeAddresses addresses_;
  RayLanes lanes_[2];
};

void cast_rays(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits) {
  if constexpr (kLanes >= 4) {
    Batch(tree, rays, hits).cast();
  } else {  // not faster than one by one
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = relumbre::cast(tree, rays[i]);
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
