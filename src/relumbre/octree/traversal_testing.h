/// Every traversal, for the tests of hits and of observers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "relumbre/octree/traverse.h"

namespace relumbre::test {

/// All kinds, short stacks of 1, 2, 3 and more nodes than any tree is deep.
inline std::vector<Traversal> all_traversals() {
  return {{Traversal::Kind::kRestart},       {Traversal::Kind::kBacktrack},
          {Traversal::Kind::kFullStack},     {Traversal::Kind::kShortStack, 1},
          {Traversal::Kind::kShortStack, 2}, {Traversal::Kind::kShortStack, 3},
          {Traversal::Kind::kShortStack, 99}};
}

inline std::string name_of(const Traversal& traversal) {
  switch (traversal.kind) {
    case Traversal::Kind::kRestart:
      return "restart";
    case Traversal::Kind::kBacktrack:
      return "backtrack";
    case Traversal::Kind::kFullStack:
      return "full stack";
    case Traversal::Kind::kShortStack:
      break;
  }
  return "short stack " + std::to_string(traversal.stack_nodes);
}

}  // namespace relumbre::test
