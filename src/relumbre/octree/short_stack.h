/// Traversal that remembers the last N nodes on its path and their words, and begins at the root
/// again when these do not go back far enough (Horn et al. 2007). As deep as the tree it never has
/// to.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/octree/stepping.h"

namespace relumbre {

namespace short_stack_detail {

/// A ring: a push onto a full one drops the node at the bottom.
class Resume {
 public:
  explicit Resume(std::size_t capacity) : capacity_(capacity) {}

  void opened(const stepping::OpenNode& node) {
    top_ = top_ + 1 == capacity_ ? 0 : top_ + 1;
    nodes_[top_] = node;
    size_ = std::min(size_ + 1, capacity_);
  }

  template <class Observer>
  stepping::OpenNode operator()(const Octree& octree, const GridRay& ray, const Place&, double now,
                                Observer& observer) {
    for (; size_ > 0; pop()) {
      const Place& place = nodes_[top_].place;
      observer.visit(place.code, level_of(place.code));
      if (now < stepping::exit_of(ray, place)) return nodes_[top_];
    }
    observer.restart();
    const stepping::OpenNode root = stepping::open_root(octree, observer);
    opened(root);
    return root;
  }

 private:
  void pop() {
    top_ = top_ == 0 ? capacity_ - 1 : top_ - 1;
    --size_;
  }

  std::size_t capacity_, top_ = 0, size_ = 0;
  std::array<stepping::OpenNode, kMaxDepth> nodes_;
};

}  // namespace short_stack_detail

/// The first voxel that the ray pierces. `nodes` is N: at least 1 (else ValueError), and more than
/// the depth makes no difference. Visits: see stepping.h; and every remembered node looked at.
template <TraversalObserver Observer>
std::optional<VoxelHit> trace_short_stack(const Octree& octree, const GridRay& ray, int nodes,
                                          Observer&& observer) {
  if (nodes < 1)
    throw ValueError("short stack: a stack of " + std::to_string(nodes) + " nodes holds nothing");
  const auto capacity = static_cast<std::size_t>(std::min(nodes, octree.depth()));
  return stepping::trace(octree, ray, short_stack_detail::Resume(capacity), observer);
}

}  // namespace relumbre
