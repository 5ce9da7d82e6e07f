/// Traversal with a stack of tasks that never overflows: the geometry unit of the simulated
/// machine.
///
/// A task is a node to be compared with the ray. The children of a node that is pierced are pushed,
/// the nearest last. Each word that is needed is read once a ray.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "relumbre/octree/octree.h"
#include "relumbre/octree/place.h"
#include "relumbre/octree/traversal_observer.h"

namespace relumbre {

namespace full_stack_detail {

struct Task {
  Place place;
  Octree::Index index;  ///< means nothing for a voxel
};

/// A node leaves, and at most its 8 children come, a level at a time.
class TaskStack {
 public:
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void push(const Task& task) { tasks_[size_++] = task; }
  Task pop() { return tasks_[--size_]; }

 private:
  std::array<Task, 7 * kMaxDepth + 1> tasks_;
  std::size_t size_ = 0;
};

/// Of a pierced internal node.
inline void push_children(TaskStack& stack, const Octree& octree, const Task& task,
                          unsigned sign_mask) {
  const NodeWord word = octree.word(task.index);
  for (unsigned rank = 8; rank-- > 0;) {
    const unsigned octant = rank ^ sign_mask;
    const ChildState state = word.child(octant);
    if (state == ChildState::kEmpty) continue;
    const bool has_word = state == ChildState::kNonEmpty;
    stack.push({task.place.child(octant),
                has_word ? octree.child(task.index, word, octant) : Octree::kNone});
  }
}

}  // namespace full_stack_detail

/// The first voxel that the ray pierces. Visits: tasks popped, voxels too, pierced or not.
template <TraversalObserver Observer>
std::optional<VoxelHit> trace_full_stack(const Octree& octree, const GridRay& ray,
                                         Observer&& observer) {
  using namespace full_stack_detail;
  observer.begin_ray(ray);
  TaskStack stack;
  stack.push({root_place(octree.depth()), 0});
  while (!stack.empty()) {
    const Task task = stack.pop();
    const Place& place = task.place;
    const int level = level_of(place.code);
    observer.visit(place.code, level);
    if (!ray.interval(place.lower, place.size).is_pierced()) continue;
    if (level == octree.depth()) return intersect_voxel(ray, place.lower);
    observer.read(place.code, level);
    push_children(stack, octree, task, ray.sign_mask());
  }
  return std::nullopt;
}

}  // namespace relumbre
