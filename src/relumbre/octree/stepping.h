/// What the traversals have in common that go along a ray from one octant to the next: restart,
/// backtrack and short stack differ only in where they resume.
///
///   now = where the ray enters the root; node = root
///   forever
///     descend from `node` to the octant that the ray is in at `now`:   a voxel?  the hit
///                                                                      empty?    now = its exit
///     outside the root?  no hit
///     node = where the traversal resumes: any node with enter <= now < exit
///
/// `now` is the parameter t, never a point, and nothing is nudged: by grid_ray.h the octants'
/// intervals partition their parent's, so that each step goes on exactly where the last one ended.
#pragma once

#include <optional>

#include "relumbre/octree/octree.h"
#include "relumbre/octree/place.h"
#include "relumbre/octree/traversal_observer.h"

namespace relumbre::stepping {

/// An internal node whose word has been read.
struct OpenNode {
  Place place;
  Octree::Index index;
  NodeWord word;
};

template <class Observer>
OpenNode open(const Octree& octree, const Place& place, Octree::Index index, Observer& observer) {
  observer.read(place.code, level_of(place.code));
  return {place, index, octree.word(index)};
}

template <class Observer>
OpenNode open_root(const Octree& octree, Observer& observer) {
  return open(octree, root_place(octree.depth()), 0, observer);
}

inline double exit_of(const GridRay& ray, const Place& place) {
  return ray.interval(place.lower, place.size).exit;
}

struct Leaf {
  Place place;
  bool is_voxel = false;
};

/// The voxel or empty octant below `node` that the ray is in at `now`. `resume` is told of every
/// node that is opened on the way.
template <class Resume, class Observer>
Leaf descend(const Octree& octree, const GridRay& ray, OpenNode node, double now, Resume& resume,
             Observer& observer) {
  for (;;) {
    const unsigned octant = ray.octant_at(node.place.center(), now);
    const Place place = node.place.child(octant);
    observer.visit(place.code, level_of(place.code));
    const ChildState state = node.word.child(octant);
    if (state != ChildState::kNonEmpty) return {place, state == ChildState::kVoxel};
    node = open(octree, place, octree.child(node.index, node.word, octant), observer);
    resume.opened(node);
  }
}

/// `resume(octree, ray, octant, now, observer)` gives the node to go on from, open, once the ray
/// has left an empty octant. Visits: the root, and every octant that is stepped into, empty ones
/// too.
template <class Resume, class Observer>
std::optional<VoxelHit> trace(const Octree& octree, const GridRay& ray, Resume resume,
                              Observer& observer) {
  observer.begin_ray(ray);
  observer.visit(kRootCode, 0);
  const RayInterval root = ray.interval({}, 1U << octree.depth());
  if (!root.is_pierced()) return std::nullopt;
  double now = root.enter;
  OpenNode node = open_root(octree, observer);
  resume.opened(node);
  for (;;) {
    const Leaf leaf = descend(octree, ray, node, now, resume, observer);
    if (leaf.is_voxel) return intersect_voxel(ray, leaf.place.lower);
    now = exit_of(ray, leaf.place);
    if (now >= root.exit) return std::nullopt;
    node = resume(octree, ray, leaf.place, now, observer);
  }
}

}  // namespace relumbre::stepping
