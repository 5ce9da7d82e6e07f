/// One ray's way through a VoxelTree, by comparisons of plane times alone. Host and device.
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
#include <cstdint>

#include "relumbre/base/host_device.h"
#include "relumbre/octree/tree_cast.h"

namespace relumbre {

/// A node on the ray's way.
struct WalkNode {
  std::uint64_t mask, first, index;
  Cell lower;
  double exit;
};

/// Keeps the nodes above as they are: little work, most memory.
class NodeStack {
 public:
  RELUMBRE_HOST_DEVICE void save(unsigned level, const WalkNode& node) { nodes_[level] = node; }
  template <class Walk>
  [[nodiscard]] RELUMBRE_HOST_DEVICE WalkNode load(const Walk&, unsigned level, const Cell&) const {
    return nodes_[level];
  }

 private:
  WalkNode nodes_[VoxelTree::kMaxLevels];
};

/// Keeps their indices; what else there is to know is found anew. For machines with little memory a
/// ray.
class IndexStack {
 public:
  RELUMBRE_HOST_DEVICE void save(unsigned level, const WalkNode& node) {
    indices_[level] = node.index;
  }
  /// `below`: the corner of a node below it.
  template <class Walk>
  [[nodiscard]] RELUMBRE_HOST_DEVICE WalkNode load(const Walk& walk, unsigned level,
                                                   const Cell& below) const {
    return walk.open_around(level, indices_[level], below);
  }

 private:
  std::uint64_t indices_[VoxelTree::kMaxLevels];
};

/// Tree: VoxelTree, or what has the same leaves(), nodes(), levels(), depth(), child_edge(),
/// rank().
template <class Tree, class Stack = NodeStack>
class TreeWalk {
 public:
  RELUMBRE_HOST_DEVICE TreeWalk(const Tree& tree, const CastRay& ray)
      : tree_(tree), ray_(ray.origin, ray.direction), t_max_(ray.t_max), spread_(ray.spread) {}

  RELUMBRE_HOST_DEVICE TreeHit first_hit() {
    const RayInterval cube = ray_.interval({0, 0, 0}, std::uint32_t{1} << tree_.depth());
    const double end = std::min(t_max_, cube.exit);  // NaN, if t_max is
    double now = cube.enter;
    node_ = open(0, 0, {0, 0, 0}, end);
    while (now < end) {
      const Child child = child_at(now);
      const std::uint32_t size = tree_.child_edge(level_);
      if (!(node_.mask >> child.bit & 1)) {
        now = exit_of_empty(child);
        while (level_ > 0 && node_.exit <= now) {
          --level_;
          node_ = stack_.load(*this, level_, node_.lower);
        }
      } else if (is_hit(now)) {
        const double enter = ray_.interval(child.lower, size).enter;
        return {{child.lower, enter, ray_.entered_axis(child.lower, size)},
                {node_.index, child.bit, level_}};
      } else {
        stack_.save(level_, node_);
        const std::uint64_t index = node_.first + Tree::rank(node_.mask, child.bit);
        ++level_;
        node_ = open(level_, index, child.lower, ray_.exit(child.lower, size));
      }
    }
    return {};
  }

  /// The node of a level that has a node with this corner somewhere below it.
  [[nodiscard]] RELUMBRE_HOST_DEVICE WalkNode open_around(unsigned level, std::uint64_t index,
                                                          const Cell& below) const {
    const std::uint32_t edge = 4 * tree_.child_edge(level), keep = ~(edge - 1);
    const Cell lower{below.x & keep, below.y & keep, below.z & keep};
    return open(level, index, lower, ray_.exit(lower, edge));
  }

 private:
  struct Child {
    Cell lower;
    unsigned bit;
  };

  /// Of a child that the ray enters now.
  [[nodiscard]] RELUMBRE_HOST_DEVICE bool is_hit(double now) const {
    return level_ + 1 == tree_.levels() || tree_.child_edge(level_) <= spread_ * now;
  }

  [[nodiscard]] RELUMBRE_HOST_DEVICE WalkNode open(unsigned level, std::uint64_t index,
                                                   const Cell& lower, double exit) const {
    if (level + 1 == tree_.levels()) return {tree_.leaves()[index], 0, index, lower, exit};
    const VoxelTree::Node node = tree_.nodes(level)[index];
    return {node.mask, node.first, index, lower, exit};
  }

  /// Two octants, one within the other.
  [[nodiscard]] RELUMBRE_HOST_DEVICE Child child_at(double now) const {
    const std::uint32_t size = tree_.child_edge(level_);
    const Cell& l = node_.lower;
    const unsigned octant = ray_.octant_at({l.x + 2 * size, l.y + 2 * size, l.z + 2 * size}, now);
    const Cell half = upper(l, octant, 2 * size);
    const unsigned inner = ray_.octant_at({half.x + size, half.y + size, half.z + size}, now);
    return {upper(half, inner, size), octant << 3 | inner};
  }

  RELUMBRE_HOST_DEVICE static Cell upper(const Cell& lower, unsigned octant, std::uint32_t size) {
    return {lower.x + (octant & 1U) * size, lower.y + (octant >> 1 & 1U) * size,
            lower.z + (octant >> 2 & 1U) * size};
  }

  /// Of the child, or of the eight around it if all are empty.
  [[nodiscard]] RELUMBRE_HOST_DEVICE double exit_of_empty(const Child& child) const {
    const std::uint32_t size = tree_.child_edge(level_);
    if ((node_.mask >> (child.bit & 56U) & 0xFF) != 0) return ray_.exit(child.lower, size);
    const std::uint32_t keep = ~(2 * size - 1);
    return ray_.exit({child.lower.x & keep, child.lower.y & keep, child.lower.z & keep}, 2 * size);
  }

  const Tree& tree_;
  GridRay ray_;
  double t_max_, spread_;
  unsigned level_ = 0;
  WalkNode node_;
  Stack stack_;
};

}  // namespace relumbre
