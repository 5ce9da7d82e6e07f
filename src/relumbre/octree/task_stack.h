/// The tasks of a traversal: nodes that are still to be compared with the ray.
#pragma once

#include <array>
#include <cstddef>

#include "relumbre/octree/octree.h"

namespace relumbre {

/// Never overflows: a node leaves, and at most its 8 children come, a level at a time. Tasks are
/// uninitialised at first.
template <class Task>
class TaskStack {
 public:
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void push(const Task& task) { tasks_[size_++] = task; }
  Task pop() { return tasks_[--size_]; }

 private:
  std::array<Task, 7 * kMaxDepth + 1> tasks_;
  std::size_t size_ = 0;
};

/// Pushes task(octant, index of its word; kNone of a voxel) for the non-empty children of a node,
/// so that the nearest is popped first: in order of octant XOR sign mask.
template <class Task, class MakeTask>
void push_children(TaskStack<Task>& stack, const Octree& octree, Octree::Index node,
                   unsigned sign_mask, const MakeTask& task) {
  const NodeWord word = octree.word(node);
  for (unsigned rank = 8; rank-- > 0;) {
    const unsigned octant = rank ^ sign_mask;
    const ChildState state = word.child(octant);
    if (state == ChildState::kEmpty) continue;
    const bool has_word = state == ChildState::kNonEmpty;
    stack.push(task(octant, has_word ? octree.child(node, word, octant) : Octree::kNone));
  }
}

}  // namespace relumbre
