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

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include <hwy/highway.h>

#include "relumbre/octree/lane_start.h"
#include "relumbre/octree/tree_addresses.h"
#include "relumbre/octree/tree_beam.h"
#include "relumbre/octree/tree_walk.h"

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using I = hn::RebindToSigned<D>;
using Doubles = hn::Vec<D>;
using Integers = hn::Vec<I>;
constexpr std::size_t kLanes = hn::MaxLanes(D());
constexpr int kLogLanes = std::countr_zero(kLanes);

/// Rays of a batch on their way, one a lane.
class RayLanes {
 public:
  RayLanes(const VoxelTree& tree, const TreeAddresses& addresses)
      : tree_(tree),
        addresses_(addresses),
        edge_(static_cast<double>(std::uint32_t{1} << tree.depth())),
        top_(2 * static_cast<std::int64_t>(tree.levels() - 1)) {
    std::ranges::fill(node_, addresses.first()[top_ / 2]);
    std::ranges::fill(shift_, top_);
    std::ranges::fill(stack_[static_cast<std::size_t>(top_ / 2)], addresses.first()[top_ / 2]);
  }

  /// Lanes without a ray, bit by bit.
  [[nodiscard]] unsigned free() const { return ~active_ & ((1U << kLanes) - 1); }
  [[nodiscard]] bool any() const { return active_ != 0; }

  /// Puts a tame ray that pierces the cube into a lane that is free.
  void start(std::size_t lane, const CastRay& cast_ray, TreeHit& hit, const CubeRay& part) {
    const GridRay& ray = part.ray;
    const double now = part.now;
    double largest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double o = ray.origin()[axis];
      const double slope = std::isfinite(ray.inverse()[axis]) ? part.direction[axis] : 0;
      origin_[axis][lane] = o;
      inverse_[axis][lane] = ray.inverse()[axis];
      slope_[axis][lane] = slope;
      cell_[axis][lane] = cell_at(ray, axis, o + slope * now, now, edge_);
      largest = std::max(largest, std::abs(o));
    }
    now_[lane] = now, end_[lane] = part.end, spread_[lane] = part.spread;
    certain_[lane] = 0.5 - 0x1p-48 * (largest + edge_);
    node_[lane] = addresses_.first()[top_ / 2];
    shift_[lane] = top_;
    axis_[lane] = -1;
    ray_[lane] = &cast_ray, hit_[lane] = &hit;
    active_ |= 1U << lane;
  }

  /// Every lane descends to a child or steps out of an empty one.
  HWY_INLINE void advance() {
    const I i;
    Integers bits[3];
    for (std::size_t a = 0; a < 3; ++a) bits[a] = bits_of(hn::Load(D(), cell_[a]));
    const Integers node = hn::Load(i, node_), shift = hn::Load(i, shift_);
    const Integers child = child_of(bits, shift);
    const Integers mask = hn::GatherOffset(i, base(), node);
    const auto exists = hn::Ne(hn::And(hn::Shr(mask, child), one()), hn::Zero(i));
    const auto is_leaf = hn::Eq(shift, hn::Zero(i));
    const Set full = active_ & set_of(exists), empty = active_ & ~full;
    const Set found = full & set_of(hn::Or(is_leaf, is_within_footprint(shift)));
    const Set inner = full & ~found;
    if (found != 0) finish(found, child);
    if (inner != 0) descend(inner, node, shift, mask, child);
    if (empty != 0) step(empty, shift, mask, child, bits);
  }

 private:
  using Set = unsigned;  ///< of lanes, bit by bit

  template <class Mask>
  static HWY_INLINE Set set_of(Mask mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(I(), hn::RebindMask(I(), mask), bits);
    return bits[0];
  }
  static HWY_INLINE hn::Mask<I> mask_of(Set set) {
    const std::uint8_t bits[8] = {static_cast<std::uint8_t>(set)};
    return hn::LoadMaskBits(I(), bits);
  }
  static HWY_INLINE Integers one() { return hn::Set(I(), 1); }
  static HWY_INLINE Doubles magic() { return hn::Set(D(), 0x1p52); }
  static HWY_INLINE Integers bits_of(Doubles cell) {
    return hn::BitCast(I(), hn::Add(cell, magic()));
  }
  [[nodiscard]] HWY_INLINE const std::int64_t* base() const {
    return reinterpret_cast<const std::int64_t*>(addresses_.base());
  }

  /// z1 y1 x1 z0 y0 x0: two bits of each coordinate.
  static HWY_INLINE Integers child_of(const Integers (&bits)[3], Integers shift) {
    const I i;
    const auto spread = [&](Integers b) {  // ...ab -> a00b
      const Integers two = hn::And(hn::Shr(b, shift), hn::Set(i, 3));
      return hn::And(hn::Or(two, hn::ShiftLeft<2>(two)), hn::Set(i, 0b1001));
    };
    return hn::Or(spread(bits[0]),
                  hn::Or(hn::ShiftLeft<1>(spread(bits[1])), hn::ShiftLeft<2>(spread(bits[2]))));
  }

  /// Whether a child that is entered now is no larger than the ray's footprint.
  [[nodiscard]] HWY_INLINE hn::Mask<I> is_within_footprint(Integers shift) const {
    const D d;
    const Doubles footprint = hn::Mul(hn::Load(d, spread_), hn::Load(d, now_));
    return hn::RebindMask(I(), hn::Le(power_of_two(shift), footprint));
  }

  static HWY_INLINE Doubles power_of_two(Integers log) {
    return hn::BitCast(D(), hn::ShiftLeft<52>(hn::Add(log, hn::Set(I(), 1023))));
  }

  /// Lanes that found a voxel, or a node within their footprint.
  HWY_INLINE void finish(Set found, Integers child) {
    alignas(64) std::int64_t bit[kLanes];
    hn::Store(child, I(), bit);
    active_ &= ~found;
    for (; found != 0; found &= found - 1) {
      const auto l = static_cast<std::size_t>(std::countr_zero(found));
      const auto height = static_cast<unsigned>(shift_[l]) / 2;
      const std::uint32_t size = std::uint32_t{1} << 2 * height;
      const auto lower = [&](std::size_t axis) {
        return static_cast<std::uint32_t>(cell_[axis][l]) & ~(size - 1);
      };
      const Cell at{lower(0), lower(1), lower(2)};
      const VoxelHit voxel =
          axis_[l] >= 0 ? VoxelHit{at, now_[l], static_cast<int>(axis_[l])}
                        : *intersect_voxel(GridRay(ray_[l]->origin, ray_[l]->direction), at, size);
      *hit_[l] = {voxel,
                  {addresses_.index(node_[l], height), static_cast<unsigned>(bit[l]),
                   tree_.levels() - 1 - height}};
    }
  }

  /// Lanes in doubt: from the start, exactly.
  HWY_INLINE void walk(Set doubtful) {
    active_ &= ~doubtful;
    for (; doubtful != 0; doubtful &= doubtful - 1) {
      const auto l = static_cast<std::size_t>(std::countr_zero(doubtful));
      *hit_[l] = cast(tree_, *ray_[l]);
    }
  }

  HWY_INLINE void descend(Set inner, Integers node, Integers shift, Integers mask, Integers child) {
    const I i;
    const hn::RebindToUnsigned<I> u;
    const auto lanes = mask_of(inner);
    const Integers below = hn::And(mask, hn::Sub(hn::Shl(one(), child), one()));
    const Integers rank = hn::BitCast(i, hn::PopulationCount(hn::BitCast(u, below)));
    // The others read some inner node.
    const Integers at = hn::IfThenElse(lanes, node, hn::Set(i, addresses_.first()[top_ / 2]));
    const Integers first = hn::GatherOffset(i, base(), hn::Add(at, hn::Set(i, 8)));
    const Integers to_shift = hn::Sub(shift, hn::Set(i, 2));
    const Integers height = hn::IfThenElseZero(lanes, hn::ShiftRight<1>(to_shift));
    const Integers index = hn::Add(first, rank);
    const Integers bytes = hn::IfThenElse(hn::Eq(height, hn::Zero(i)), hn::ShiftLeft<3>(index),
                                          hn::ShiftLeft<4>(index));
    const Integers to = hn::Add(hn::GatherIndex(i, addresses_.first(), height), bytes);
    hn::BlendedStore(to, lanes, i, node_);
    hn::BlendedStore(to_shift, lanes, i, shift_);
    for (std::int64_t h = 0; h < top_; h += 2) {
      const auto here = hn::And(lanes, hn::Eq(to_shift, hn::Set(i, h)));
      hn::BlendedStore(to, here, i, stack_[static_cast<std::size_t>(h / 2)]);
    }
  }

  /// Out of the child, or of the eight around it if all are empty.
  HWY_INLINE void step(Set empty, Integers shift, Integers mask, Integers child,
                       const Integers (&bits)[3]) {
    const D d;
    const I i;
    const Integers octant = hn::And(hn::Shr(mask, hn::And(child, hn::Set(i, 56))), hn::Set(i, 255));
    const Integers log = hn::Add(shift, hn::IfThenElseZero(hn::Eq(octant, hn::Zero(i)), one()));
    const Integers keep = hn::Shl(hn::Set(i, -1), log);
    const Doubles size = power_of_two(log);
    Doubles far[3], t[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const Doubles lower = hn::Sub(hn::BitCast(d, hn::And(bits[a], keep)), magic());
      const Doubles inverse = hn::Load(d, inverse_[a]);
      far[a] = hn::Add(lower, hn::IfThenElseZero(hn::Gt(inverse, hn::Zero(d)), size));
      t[a] = hn::Mul(hn::Sub(far[a], hn::Load(d, origin_[a])), inverse);
    }
    const Doubles exit = hn::Min(t[0], hn::Min(t[1], t[2]));
    const auto first = hn::Eq(t[0], exit), second = hn::Eq(t[1], exit);
    const hn::Mask<D> crossed[3] = {first, hn::AndNot(first, second),
                                    hn::Not(hn::Or(first, second))};
    const Doubles half = hn::Set(d, 0.5), certain = hn::Load(d, certain_);
    const Set left = empty & set_of(hn::Ge(exit, hn::Load(d, end_)));
    active_ &= ~left;
    const auto moving = mask_of(empty & ~left);
    Integers changed = hn::Zero(i);
    Doubles worst = hn::Zero(d);
    for (std::size_t a = 0; a < 3; ++a) {
      const Doubles point = hn::MulAdd(hn::Load(d, slope_[a]), exit, hn::Load(d, origin_[a]));
      const Doubles floor = hn::Floor(point);
      const Doubles off_center = hn::Abs(hn::Sub(hn::Sub(point, floor), half));
      worst = hn::Max(worst, hn::IfThenZeroElse(crossed[a], off_center));
      const auto is_down = hn::Lt(hn::Load(d, inverse_[a]), hn::Zero(d));
      const Doubles beyond = hn::Sub(far[a], hn::IfThenElseZero(is_down, hn::Set(d, 1)));
      const Doubles cell = hn::IfThenElse(crossed[a], beyond, floor);
      changed = hn::Or(changed, hn::Xor(bits[a], bits_of(cell)));
      hn::BlendedStore(cell, hn::RebindMask(d, moving), d, cell_[a]);
    }
    hn::BlendedStore(exit, hn::RebindMask(d, moving), d, now_);
    const Integers axis =
        hn::IfThenElse(hn::RebindMask(i, first), hn::Zero(i),
                       hn::IfThenElse(hn::RebindMask(i, second), one(), hn::Set(i, 2)));
    hn::BlendedStore(axis, moving, i, axis_);
    const Set doubtful = empty & ~left & ~set_of(hn::Lt(worst, certain));
    climb(empty & ~left & ~doubtful, shift, changed);
    if (HWY_UNLIKELY(doubtful != 0)) walk(doubtful);
  }

  /// To the node that has both the cell left and the cell entered.
  HWY_INLINE void climb(Set moving, Integers shift, Integers changed) {
    const D d;
    const I i;
    const auto lanes = mask_of(moving);
    const Doubles number =
        hn::Sub(hn::BitCast(d, hn::Or(changed, hn::BitCast(i, magic()))), magic());
    const Integers highest = hn::Sub(hn::ShiftRight<52>(hn::BitCast(i, number)), hn::Set(i, 1023));
    const Integers to_shift =
        hn::IfThenElse(lanes, hn::Max(shift, hn::AndNot(one(), highest)), shift);
    const Integers slot =
        hn::Add(hn::ShiftLeft<kLogLanes>(hn::ShiftRight<1>(to_shift)), hn::Iota(i, 0));
    const Integers to = hn::GatherIndex(i, &stack_[0][0], slot);
    hn::BlendedStore(to, lanes, i, node_);
    hn::BlendedStore(to_shift, lanes, i, shift_);
  }

  const VoxelTree& tree_;
  const TreeAddresses& addresses_;
  double edge_;
  std::int64_t top_;  ///< log2 of the edge of the root's children
  Set active_ = 0;
  alignas(64) double origin_[3][kLanes] = {}, inverse_[3][kLanes] = {}, slope_[3][kLanes] = {};
  alignas(64) double cell_[3][kLanes] = {}, now_[kLanes] = {}, end_[kLanes] = {};
  alignas(64) double spread_[kLanes] = {};
  alignas(64) double certain_[kLanes] = {};
  alignas(64) std::int64_t node_[kLanes], shift_[kLanes], axis_[kLanes] = {};
  alignas(64) std::int64_t stack_[VoxelTree::kMaxLevels][kLanes] = {};
  const CastRay* ray_[kLanes] = {};
  TreeHit* hit_[kLanes] = {};
};

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
