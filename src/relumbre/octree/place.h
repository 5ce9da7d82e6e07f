/// Where a traversal is: a node, internal, voxel or empty, and its box.
#pragma once

#include "relumbre/octree/location_code.h"

namespace relumbre {

/// Uninitialised by default: traversals keep stacks of them.
struct Place {
  LocationCode code;
  Cell lower;          ///< corner, in cells of the deepest level
  std::uint32_t size;  ///< edge

  [[nodiscard]] Place child(unsigned octant) const {
    const std::uint32_t half = size / 2;
    return {child_of(code, octant),
            {lower.x + (octant & 1U) * half, lower.y + (octant >> 1 & 1U) * half,
             lower.z + (octant >> 2) * half},
            half};
  }
  [[nodiscard]] Place parent() const {
    const std::uint32_t keep = ~(2 * size - 1);
    return {parent_of(code), {lower.x & keep, lower.y & keep, lower.z & keep}, 2 * size};
  }
  [[nodiscard]] Cell center() const {
    return {lower.x + size / 2, lower.y + size / 2, lower.z + size / 2};
  }
};

/// Of a tree of this depth.
inline Place root_place(int depth) { return {kRootCode, {0, 0, 0}, std::uint32_t{1} << depth}; }

}  // namespace relumbre
