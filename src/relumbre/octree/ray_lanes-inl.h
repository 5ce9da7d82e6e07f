// One ray a lane, through a VoxelTree: included by cast_kernels.cpp for each instruction set.
//
// As in tree_walk.h, `now` is always some plane's time t(k) = (k - o) · (1/d) or the start. A step
// to the exit of an empty block is decided by comparing the times of the block's three far planes.
// The cell that the ray is in then, along the two axes that it does not cross, is the floor of
// o + d · now if that is not too near to an integer to be sure: computed times differ from real
// ones by 3 roundings, and the point by 2, each of at most 2^-53 (|o| + edge), so that outside of
// `doubt` = 2^-48 (|o| + edge) around plane k the order of t(k) and `now` is the point's side of k.
// A ray that comes into doubt (it passes an edge of a cell, or as good as) is walked by
// tree_walk.h.
//
// Coordinates are integers in doubles. Added to 2^52, their bits are the lowest of the mantissa.

#if defined(RELUMBRE_OCTREE_RAY_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMBRE_OCTREE_RAY_LANES_INL_H_
#undef RELUMBRE_OCTREE_RAY_LANES_INL_H_
#else
#define RELUMBRE_OCTREE_RAY_LANES_INL_H_
#endif

#include <array>
#include <cstdint>
#include <span>

#include <hwy/highway.h>

#include "relumbre/octree/ray_queue.h"
#include "relumbre/octree/tree_addresses.h"
#include "relumbre/octree/tree_walk.h"

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using I = hn::RebindToSigned<D>;
using Doubles = hn::Vec<D>;
using Integers = hn::Vec<I>;
using Lanes = hn::Mask<D>;
constexpr std::size_t kLanes = hn::MaxLanes(D());

class RayLanes {
 public:
  RayLanes(const VoxelTree& tree, const TreeAddresses& addresses, RayQueue& queue,
           std::span<const CastRay> rays, std::span<TreeHit> hits)
      : tree_(tree),
        addresses_(addresses),
        queue_(queue),
        rays_(rays),
        hits_(hits),
        top_(2 * static_cast<std::int64_t>(tree.levels() - 1)),
        active_(none()) {}

  /// Takes rays from the queue's end into lanes that are free. False if there is nothing to do.
  HWY_INLINE bool refill() {
    const std::size_t free = kLanes - hn::CountTrue(D(), active_);
    const std::size_t taken = std::min(free, queue_.size);
    if (taken != 0) take(taken);
    return !hn::AllFalse(D(), active_);
  }

  /// Every lane descends to a child or steps out of an empty one.
  HWY_INLINE void advance() {
    const I i;
    Integers bits[3];
    for (std::size_t a = 0; a < 3; ++a) bits[a] = bits_of(cell_[a]);
    const Integers child = child_of(bits);
    const Integers mask = hn::GatherOffset(i, base(), node_);
    const auto exists = hn::Ne(hn::And(hn::Shr(mask, child), one()), hn::Zero(i));
    const auto is_leaf = hn::Eq(shift_, hn::Zero(i));
    const Lanes full = hn::And(active_, hn::RebindMask(D(), exists));
    const Lanes found = hn::And(full, hn::RebindMask(D(), is_leaf));
    const Lanes inner = hn::AndNot(found, full);
    const Lanes empty = hn::AndNot(full, active_);
    if (!hn::AllFalse(D(), found)) finish(found, child);
    if (!hn::AllFalse(D(), inner)) descend(hn::RebindMask(i, inner), mask, child);
    if (!hn::AllFalse(D(), empty)) step(empty, mask, child, bits);
  }

  [[nodiscard]] HWY_INLINE std::size_t free_lanes() const {
    return kLanes - hn::CountTrue(D(), active_);
  }

 private:
  static HWY_INLINE Lanes none() { return hn::FirstN(D(), 0); }
  static HWY_INLINE Integers one() { return hn::Set(I(), 1); }
  static HWY_INLINE Doubles magic() { return hn::Set(D(), 0x1p52); }
  static HWY_INLINE Integers bits_of(Doubles cell) {
    return hn::BitCast(I(), hn::Add(cell, magic()));
  }
  [[nodiscard]] HWY_INLINE const std::int64_t* base() const {
    return reinterpret_cast<const std::int64_t*>(addresses_.base());
  }

  HWY_INLINE void take(std::size_t taken) {
    alignas(64) std::int64_t slot[kLanes];
    alignas(64) std::int64_t is_active[kLanes];
    hn::Store(hn::VecFromMask(I(), hn::RebindMask(I(), active_)), I(), is_active);
    std::size_t next = queue_.size - taken;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const bool is_filled = is_active[lane] == 0 && next < queue_.size;
      slot[lane] = is_filled ? static_cast<std::int64_t>(next++) : -1;
    }
    queue_.size -= taken;
    load(hn::Load(I(), slot));
  }

  HWY_INLINE void load(Integers slot) {
    const auto filled = hn::Gt(slot, hn::Set(I(), -1));
    const Lanes lanes = hn::RebindMask(D(), filled);
    const Integers from = hn::IfThenElseZero(filled, slot);
    const auto replace = [&](Doubles& v, const RayQueue::Numbers& numbers) {
      v = hn::IfThenElse(lanes, hn::GatherIndex(D(), numbers.data(), from), v);
    };
    for (std::size_t a = 0; a < 3; ++a) {
      replace(origin_[a], queue_.origin[a]);
      replace(inverse_[a], queue_.inverse[a]);
      replace(slope_[a], queue_.slope[a]);
      replace(cell_[a], queue_.cell[a]);
    }
    replace(now_, queue_.now);
    replace(end_, queue_.end);
    replace(doubt_, queue_.doubt);
    const auto* ray = reinterpret_cast<const std::int64_t*>(queue_.ray.data());
    ray_ = hn::IfThenElse(filled, hn::GatherIndex(I(), ray, from), ray_);
    const Integers root = hn::Set(I(), addresses_.first()[top_ / 2]);
    node_ = hn::IfThenElse(filled, root, node_);
    shift_ = hn::IfThenElse(filled, hn::Set(I(), top_), shift_);
    axis_ = hn::IfThenElse(filled, hn::Set(I(), -1), axis_);
    hn::BlendedStore(root, filled, I(), stack_[static_cast<std::size_t>(top_ / 2)]);
    active_ = hn::Or(active_, lanes);
  }

  /// z1 y1 x1 z0 y0 x0: two bits of each coordinate.
  [[nodiscard]] HWY_INLINE Integers child_of(const Integers (&bits)[3]) const {
    const I i;
    const auto low = [&](Integers b) {  // ...ab -> a..b
      const Integers two = hn::And(hn::Shr(b, shift_), hn::Set(i, 3));
      return hn::And(hn::Or(two, hn::ShiftLeft<2>(two)), hn::Set(i, 0b1001));
    };
    return hn::Or(low(bits[0]),
                  hn::Or(hn::ShiftLeft<1>(low(bits[1])), hn::ShiftLeft<2>(low(bits[2]))));
  }

  /// Lanes that found a voxel.
  HWY_INLINE void finish(Lanes found, Integers child) {
    alignas(64) double cell[3][kLanes], now[kLanes];
    alignas(64) std::int64_t node[kLanes], bit[kLanes], axis[kLanes], ray[kLanes], done[kLanes];
    for (std::size_t a = 0; a < 3; ++a) hn::Store(cell_[a], D(), cell[a]);
    hn::Store(now_, D(), now);
    hn::Store(node_, I(), node), hn::Store(child, I(), bit);
    hn::Store(axis_, I(), axis), hn::Store(ray_, I(), ray);
    hn::Store(hn::VecFromMask(I(), hn::RebindMask(I(), found)), I(), done);
    for (std::size_t l = 0; l < kLanes; ++l) {
      if (done[l] == 0) continue;
      const auto r = static_cast<std::size_t>(ray[l]);
      const Cell at{static_cast<std::uint32_t>(cell[0][l]), static_cast<std::uint32_t>(cell[1][l]),
                    static_cast<std::uint32_t>(cell[2][l])};
      const VoxelHit voxel =
          axis[l] >= 0 ? VoxelHit{at, now[l], static_cast<int>(axis[l])}
                       : *intersect_voxel(GridRay(rays_[r].origin, rays_[r].direction), at);
      hits_[r] = {voxel, static_cast<std::uint64_t>(node[l]) / sizeof(std::uint64_t),
                  static_cast<unsigned>(bit[l])};
    }
    active_ = hn::AndNot(found, active_);
  }

  /// Lanes in doubt: from the start, exactly.
  HWY_INLINE void walk(Lanes doubtful) {
    alignas(64) std::int64_t ray[kLanes], done[kLanes];
    hn::Store(ray_, I(), ray);
    hn::Store(hn::VecFromMask(I(), hn::RebindMask(I(), doubtful)), I(), done);
    for (std::size_t l = 0; l < kLanes; ++l) {
      if (done[l] == 0) continue;
      const auto r = static_cast<std::size_t>(ray[l]);
      hits_[r] = cast(tree_, GridRay(rays_[r].origin, rays_[r].direction), rays_[r].t_max);
    }
  }

  HWY_INLINE void descend(hn::Mask<I> lanes, Integers mask, Integers child) {
    const I i;
    const Integers below = hn::And(mask, hn::Sub(hn::Shl(one(), child), one()));
    const hn::RebindToUnsigned<I> u;
    const Integers rank = hn::BitCast(i, hn::PopulationCount(hn::BitCast(u, below)));
    const Integers at = hn::IfThenElse(lanes, node_, hn::Set(i, addresses_.first()[top_ / 2]));
    const Integers first = hn::GatherOffset(i, base(), hn::Add(at, hn::Set(i, 8)));
    const Integers shift = hn::Sub(shift_, hn::Set(i, 2));
    const Integers height = hn::IfThenElseZero(lanes, hn::ShiftRight<1>(shift));
    const Integers index = hn::Add(first, rank);
    const Integers bytes = hn::IfThenElse(hn::Eq(height, hn::Zero(i)), hn::ShiftLeft<3>(index),
                                          hn::ShiftLeft<4>(index));
    const Integers node = hn::Add(hn::GatherIndex(i, addresses_.first(), height), bytes);
    node_ = hn::IfThenElse(lanes, node, node_);
    shift_ = hn::IfThenElse(lanes, shift, shift_);
    for (std::int64_t h = 0; h < top_; h += 2) {
      const auto here = hn::And(lanes, hn::Eq(shift_, hn::Set(i, h)));
      hn::BlendedStore(node_, here, i, stack_[static_cast<std::size_t>(h / 2)]);
    }
  }

  /// Out of the child, or of the eight around it if all are empty.
  HWY_INLINE void step(Lanes lanes, Integers mask, Integers child, const Integers (&bits)[3]) {
    const D d;
    const I i;
    const Integers octant = hn::And(hn::Shr(mask, hn::And(child, hn::Set(i, 56))), hn::Set(i, 255));
    const Integers log = hn::Add(shift_, hn::IfThenElseZero(hn::Eq(octant, hn::Zero(i)), one()));
    const Integers keep = hn::Shl(hn::Set(i, -1), log);
    const Doubles size = hn::BitCast(d, hn::ShiftLeft<52>(hn::Add(log, hn::Set(i, 1023))));
    Doubles far[3], t[3];
    Lanes up[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const Doubles lower = hn::Sub(hn::BitCast(d, hn::And(bits[a], keep)), magic());
      up[a] = hn::Gt(inverse_[a], hn::Zero(d));
      far[a] = hn::Add(lower, hn::IfThenElseZero(up[a], size));
      t[a] = hn::Mul(hn::Sub(far[a], origin_[a]), inverse_[a]);
    }
    const Doubles exit = hn::Min(t[0], hn::Min(t[1], t[2]));
    const Lanes left = hn::And(lanes, hn::Ge(exit, end_));
    Lanes sure = hn::Not(none()), crossed[3];
    crossed[0] = hn::Eq(t[0], exit);
    crossed[1] = hn::AndNot(crossed[0], hn::Eq(t[1], exit));
    crossed[2] = hn::Not(hn::Or(crossed[0], crossed[1]));
    const Doubles half = hn::Set(d, 0.5), certain = hn::Sub(half, doubt_);
    Integers changed = hn::Zero(i);
    const Lanes on = hn::AndNot(left, lanes);
    for (std::size_t a = 0; a < 3; ++a) {
      const Doubles point = hn::MulAdd(slope_[a], exit, origin_[a]), floor = hn::Floor(point);
      const Doubles off_center = hn::Abs(hn::Sub(hn::Sub(point, floor), half));
      sure = hn::And(sure, hn::Or(crossed[a], hn::Lt(off_center, certain)));
      const Doubles beyond = hn::IfThenElse(up[a], far[a], hn::Sub(far[a], hn::Set(d, 1)));
      const Doubles cell = hn::IfThenElse(crossed[a], beyond, floor);
      changed = hn::Or(changed, hn::Xor(bits[a], bits_of(cell)));
      cell_[a] = hn::IfThenElse(on, cell, cell_[a]);
    }
    now_ = hn::IfThenElse(on, exit, now_);
    const Integers axis =
        hn::IfThenElse(hn::RebindMask(i, crossed[0]), hn::Zero(i),
                       hn::IfThenElse(hn::RebindMask(i, crossed[1]), one(), hn::Set(i, 2)));
    const Lanes doubtful = hn::AndNot(sure, on);
    const Lanes go = hn::And(sure, on);
    axis_ = hn::IfThenElse(hn::RebindMask(i, go), axis, axis_);
    climb(hn::RebindMask(i, go), changed);
    if (!hn::AllFalse(d, doubtful)) walk(doubtful);
    active_ = hn::AndNot(hn::Or(left, doubtful), active_);
  }

  /// To the node that has both the cell left and the cell entered.
  HWY_INLINE void climb(hn::Mask<I> lanes, Integers changed) {
    const I i;
    const D d;
    const Doubles number =
        hn::Sub(hn::BitCast(d, hn::Or(changed, hn::BitCast(i, magic()))), magic());
    const Integers highest = hn::Sub(hn::ShiftRight<52>(hn::BitCast(i, number)), hn::Set(i, 1023));
    const Integers shift = hn::Max(shift_, hn::AndNot(one(), highest));
    shift_ = hn::IfThenElse(lanes, shift, shift_);
    const Integers lane = hn::Iota(i, 0);
    static_assert((kLanes & (kLanes - 1)) == 0);
    const Integers slot = hn::Add(hn::Mul(hn::ShiftRight<1>(shift_), hn::Set(i, kLanes)), lane);
    node_ = hn::IfThenElse(lanes, hn::GatherIndex(i, &stack_[0][0], slot), node_);
  }

  const VoxelTree& tree_;
  const TreeAddresses& addresses_;
  RayQueue& queue_;
  std::span<const CastRay> rays_;
  std::span<TreeHit> hits_;
  std::int64_t top_;  ///< log2 of the edge of the root's children
  Doubles origin_[3] = {hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
  Doubles inverse_[3] = {hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
  Doubles slope_[3] = {hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
  Doubles cell_[3] = {hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
  Doubles now_ = hn::Zero(D()), end_ = hn::Zero(D()), doubt_ = hn::Zero(D());
  Integers node_ = hn::Zero(I()), shift_ = hn::Zero(I()), axis_ = hn::Zero(I());
  Integers ray_ = hn::Zero(I());
  Lanes active_;
  alignas(64) std::int64_t stack_[VoxelTree::kMaxLevels][kLanes] = {};
};

HWY_INLINE void cast_queue(const VoxelTree& tree, const TreeAddresses& addresses, RayQueue& queue,
                           std::span<const CastRay> rays, std::span<TreeHit> hits) {
  RayLanes lanes(tree, addresses, queue, rays, hits);
  while (lanes.refill()) {
    do lanes.advance();
    while (lanes.free_lanes() < kLanes / 4);
  }
}

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
