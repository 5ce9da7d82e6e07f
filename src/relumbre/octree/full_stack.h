/// Traversal with a stack of tasks that never overflows. geometry_unit.h, what the simulated
/// machine does, differs in its notion of a hit: closed boxes.
///
/// A task is a node to be compared with the ray. The children of a node that is pierced are pushed,
/// the nearest last. Each word that is needed is read once a ray.
#pragma once

#include <optional>

#include "relumbre/octree/octree.h"
#include "relumbre/octree/place.h"
#include "relumbre/octree/task_stack.h"
#include "relumbre/octree/traversal_observer.h"

namespace relumbre {

namespace full_stack_detail {

struct Task {
  Place place;
  Octree::Index index;  ///< means nothing for a voxel
};

}  // namespace full_stack_detail

/// The first voxel that the ray pierces. Visits: tasks popped, voxels too, pierced or not.
template <TraversalObserver Observer>
std::optional<VoxelHit> trace_full_stack(const Octree& octree, const GridRay& ray,
                                         Observer&& observer) {
  using namespace full_stack_detail;
  observer.begin_ray(ray);
  TaskStack<Task> stack;
  stack.push({root_place(octree.depth()), 0});
  while (!stack.empty()) {
    const Task task = stack.pop();
    const Place& place = task.place;
    const int level = level_of(place.code);
    observer.visit(place.code, level);
    if (!ray.interval(place.lower, place.size).is_pierced()) continue;
    if (level == octree.depth()) return intersect_voxel(ray, place.lower);
    observer.read(place.code, level);
    push_children(stack, octree, task.index, ray.sign_mask(),
                  [&](unsigned octant, Octree::Index child) {
                    return Task{place.child(octant), child};
                  });
  }
  return std::nullopt;
}

}  // namespace relumbre
