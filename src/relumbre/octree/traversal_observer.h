/// What a traversal tells of itself while it runs: for counts, heat maps and simulated memories.
///
/// A traversal is a template over its observer and takes it by reference. An observer's functions
/// are called in the order in which the things happen. With NoObserver they compile to nothing.
#pragma once

#include <concepts>

#include "relumbre/octree/grid_ray.h"
#include "relumbre/octree/location_code.h"

namespace relumbre {

template <class T>
concept TraversalObserver = requires(T observer, const GridRay& ray, LocationCode code, int level) {
  observer.begin_ray(ray);      // before anything else
  observer.visit(code, level);  // a node's box is compared with the ray: see each traversal
  observer.read(code, level);   // the word of an internal node is fetched from the octree
  observer.restart();           // the traversal forgets where it was and begins at the root
};

struct NoObserver {
  void begin_ray(const GridRay&) {}
  void visit(LocationCode, int) {}
  void read(LocationCode, int) {}
  void restart() {}
};
static_assert(TraversalObserver<NoObserver>);

}  // namespace relumbre
