/// One ray's way through a VoxelTree, by comparisons of plane times alone.
///
///   now = where the ray enters the cube; node = root
///   forever
///     the child that the ray is in at `now`:   voxel, or a node within the footprint?   the hit
///                                              node?    push it
///                                              empty?   now = exit of the largest empty block
///     pop the nodes that end by `now`
///
/// By grid_ray.h the intervals [enter, exit) of a node's children partition its own, so that each
/// step goes on exactly where the last one ended.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "relumbre/octree/tree_cast.h"

namespace relumbre {

class TreeWalk {
 public:
  TreeWalk(const VoxelTree& tree, const CastRay& ray)
      : tree_(tree), ray_(ray.origin, ray.direction), t_max_(ray.t_max), spread_(ray.spread) {}

  TreeHit first_hit() {
    const RayInterval cube = ray_.interval({}, std::uint32_t{1} << tree_.depth());
    const double end = std::min(t_max_, cube.exit);  // NaN, if t_max is
    double now = cube.enter;
    push(0, {}, end);
    while (now < end) {
      const Node& node = stack_[level_];
      const Child child = child_at(node, now);
      if (!(node.mask >> child.bit & 1)) {
        now = exit_of_empty(node, child);
        while (level_ > 0 && stack_[level_].exit <= now) --level_;
      } else if (is_hit(now)) {
        return {*intersect_voxel(ray_, child.lower, tree_.child_edge(level_)),
                {node.index, child.bit, level_}};
      } else {
        const std::uint64_t index = node.first + VoxelTree::rank(node.mask, child.bit);
        ++level_;
        push(index, child.lower, ray_.exit(child.lower, tree_.child_edge(level_ - 1)));
      }
    }
    return {};
  }

 private:
  struct Node {
    std::uint64_t mask, first, index;
    Cell lower;
    double exit;
  };
  struct Child {
    Cell lower;
    unsigned bit;
  };

  /// Of a child that the ray enters now.
  [[nodiscard]] bool is_hit(double now) const {
    return level_ + 1 == tree_.levels() || tree_.child_edge(level_) <= spread_ * now;
  }

  void push(std::uint64_t index, const Cell& lower, double exit) {
    const bool is_leaf = level_ + 1 == tree_.levels();
    const VoxelTree::Node node =
        is_leaf ? VoxelTree::Node{tree_.leaves()[index], 0} : tree_.nodes(level_)[index];
    stack_[level_] = {node.mask, node.first, index, lower, exit};
  }

  /// Two octants, one within the other.
  [[nodiscard]] Child child_at(const Node& node, double now) const {
    const std::uint32_t size = tree_.child_edge(level_);
    const Cell& l = node.lower;
    const unsigned octant = ray_.octant_at({l.x + 2 * size, l.y + 2 * size, l.z + 2 * size}, now);
    const Cell half = upper(l, octant, 2 * size);
    const unsigned inner = ray_.octant_at({half.x + size, half.y + size, half.z + size}, now);
    return {upper(half, inner, size), octant << 3 | inner};
  }

  static Cell upper(const Cell& lower, unsigned octant, std::uint32_t size) {
    return {lower.x + (octant & 1U) * size, lower.y + (octant >> 1 & 1U) * size,
            lower.z + (octant >> 2 & 1U) * size};
  }

  /// Of the child, or of the eight around it if all are empty.
  [[nodiscard]] double exit_of_empty(const Node& node, const Child& child) const {
    const std::uint32_t size = tree_.child_edge(level_);
    if ((node.mask >> (child.bit & 56U) & 0xFF) != 0) return ray_.exit(child.lower, size);
    const std::uint32_t keep = ~(2 * size - 1);
    return ray_.exit({child.lower.x & keep, child.lower.y & keep, child.lower.z & keep}, 2 * size);
  }

  const VoxelTree& tree_;
  GridRay ray_;
  double t_max_, spread_;
  unsigned level_ = 0;
  std::array<Node, VoxelTree::kMaxLevels> stack_;
};

}  // namespace relumbre
