/// Traversal without a stack that climbs to the first ancestor that the ray is still in. Its
/// location code is a shift, and its word is read again (Foley and Sugerman 2005, for kd-trees with
/// pointers).
#pragma once

#include <optional>

#include "relumbre/octree/stepping.h"

namespace relumbre {

namespace backtrack_detail {

struct Resume {
  void opened(const stepping::OpenNode&) {}

  /// There is one, since the ray is still in the root.
  template <class Observer>
  stepping::OpenNode operator()(const Octree& octree, const GridRay& ray, Place place, double now,
                                Observer& observer) {
    do {
      place = place.parent();
      observer.visit(place.code, level_of(place.code));
    } while (stepping::exit_of(ray, place) <= now);
    return stepping::open(octree, place, octree.find(place.code), observer);
  }
};

}  // namespace backtrack_detail

/// The first voxel that the ray pierces. Visits: see stepping.h; and every ancestor climbed to.
template <TraversalObserver Observer>
std::optional<VoxelHit> trace_backtrack(const Octree& octree, const GridRay& ray,
                                        Observer&& observer) {
  return stepping::trace(octree, ray, backtrack_detail::Resume{}, observer);
}

}  // namespace relumbre
