/// From a hit point to the patch or element under it, as fast as possible.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/geometry/descend.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {

/// Where a LabelLocator lies, in the memory of the side that asks: CPU or GPU.
struct LabelView {
  const std::int32_t* roots;
  const std::int32_t* nodes;

  [[nodiscard]] RELUMBRE_HOST_DEVICE std::uint32_t find(std::uint32_t triangle, bool back, float u,
                                                        float v) const {
    const std::int32_t root = roots[2 * std::size_t{triangle} + (back ? 1 : 0)];
    if (root == FacetLocator::kMissing) return kNone;
    float first = back ? v : u, second = back ? u : v;
    return static_cast<std::uint32_t>(~descend(nodes, root, first, second));
  }
};

/// A FacetLocator whose leaves hold labels and whose subtrees of one label are a single leaf: a
/// source triangle that lies in one patch is found in one step. Same layout as FacetLocator, with
/// ~label for ~facet; inner nodes are in depth-first order, so that descents stay in cache.
struct LabelLocator {
  std::vector<std::int32_t> roots;  ///< 2 per source triangle; FacetLocator::kMissing
  std::vector<std::int32_t> nodes;  ///< 4 per inner node

  /// Label under the point with source barycentrics (u, v) on one side of a source triangle; kNone
  /// where that side does not reflect. O(depth of the cuts). Thread-safe.
  [[nodiscard]] std::uint32_t find(std::uint32_t triangle, bool back, float u, float v) const {
    return LabelView{roots.data(), nodes.data()}.find(triangle, back, u, v);
  }
};

/// Labels must be below 2^31. Throws ShapeError if the locator names a facet that has no label.
/// O(facets).
LabelLocator prune(const FacetLocator& locator, std::span<const std::uint32_t> label_of_facet);

}  // namespace relumbre
