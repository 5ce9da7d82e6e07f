/// Internal: the binary hierarchy that a Bvh is made from.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/base/box.h"

namespace relumbre::bvh {

/// A triangle as the builder sees it.
struct Primitive {
  Box box;
  std::uint32_t triangle;
};

/// One to three consecutive primitives, or an inner node.
///
///   bit  31    30 29    28 ... 0
///        leaf  count    first primitive, or number of the inner node
struct Reference {
  std::uint32_t bits = 0;

  static Reference leaf(std::size_t first, std::size_t count) {
    return {static_cast<std::uint32_t>(first | count << 29 | std::size_t{1} << 31)};
  }
  static Reference inner(std::size_t node) { return {static_cast<std::uint32_t>(node)}; }
  [[nodiscard]] bool is_leaf() const { return bits >> 31 != 0; }
  [[nodiscard]] std::uint32_t count() const { return bits >> 29 & 3U; }
  [[nodiscard]] std::uint32_t index() const { return bits & 0x1FFFFFFFU; }
};

struct BinaryChild {
  Box box;
  Reference what;
};

/// Inner node m separates primitive m - 1 from primitive m, so that nodes can be made in any order
/// and by many threads without a word between them.
struct BinaryTree {
  std::vector<std::array<BinaryChild, 2>> inner;  ///< as many as primitives; some are unused
  BinaryChild root;
};

inline constexpr std::size_t kMaxLeaf = 3;

/// Reorders `primitives` (1 to 2^28) so that every node has a range of them. No path from the root
/// has more than `max_depth` inner nodes (at least 32).
BinaryTree build_binary(std::vector<Primitive>& primitives, std::size_t max_depth);

/// Half of a box's area; 0 for an empty one.
inline double half_area(const Box& box) {
  const Vec3d size(box.size());
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

inline void extend(Box& box, const Box& other) {
  box.lower = min(box.lower, other.lower), box.upper = max(box.upper, other.upper);
}

}  // namespace relumbre::bvh
