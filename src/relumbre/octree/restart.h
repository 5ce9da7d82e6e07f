/// Traversal without a stack that begins at the root again for every octant (Foley and Sugerman
/// 2005).
#pragma once

#include <optional>

#include "relumbre/octree/stepping.h"

namespace relumbre {

namespace restart_detail {

struct Resume {
  void opened(const stepping::OpenNode&) {}

  template <class Observer>
  stepping::OpenNode operator()(const Octree& octree, const GridRay&, const Place&, double,
                                Observer& observer) {
    observer.restart();
    return stepping::open_root(octree, observer);
  }
};

}  // namespace restart_detail

/// The first voxel that the ray pierces. Visits: see stepping.h.
template <TraversalObserver Observer>
std::optional<VoxelHit> trace_restart(const Octree& octree, const GridRay& ray,
                                      Observer&& observer) {
  return stepping::trace(octree, ray, restart_detail::Resume{}, observer);
}

}  // namespace relumbre
