/// The traversals of the architectural octree, chosen at run time. All return the same hit for
/// every ray, that of grid_ray.h; they differ in the words they read.
///
///   kRestart      from the root for every octant     no memory of its own
///   kBacktrack    up to the common ancestor          a location code
///   kFullStack    a stack of tasks                   7·depth + 1 tasks
///   kShortStack   the last N nodes, else the root    N nodes with their words
///
/// Rays are in grid coordinates: see grid_ray.h.
#pragma once

#include <optional>

#include "relumbre/octree/backtrack.h"
#include "relumbre/octree/full_stack.h"
#include "relumbre/octree/restart.h"
#include "relumbre/octree/short_stack.h"

namespace relumbre {

struct Traversal {
  enum class Kind { kRestart, kBacktrack, kFullStack, kShortStack };
  Kind kind = Kind::kFullStack;
  int stack_nodes = 4;  ///< N of kShortStack, at least 1
};

/// The first voxel that the ray pierces, if any. Throws ValueError for a short stack without nodes.
template <TraversalObserver Observer = NoObserver>
std::optional<VoxelHit> trace(const Octree& octree, const GridRay& ray, const Traversal& traversal,
                              Observer&& observer = {}) {
  switch (traversal.kind) {
    case Traversal::Kind::kRestart:
      return trace_restart(octree, ray, observer);
    case Traversal::Kind::kBacktrack:
      return trace_backtrack(octree, ray, observer);
    case Traversal::Kind::kShortStack:
      return trace_short_stack(octree, ray, traversal.stack_nodes, observer);
    case Traversal::Kind::kFullStack:
      break;
  }
  return trace_full_stack(octree, ray, observer);
}

}  // namespace relumbre
