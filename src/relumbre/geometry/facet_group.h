/// How compact a set of facets is in position and orientation, and where to divide it.
#pragma once

#include <cstdint>
#include <span>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/facet_forest.h"

namespace relumbre {

/// What the clustering knows of a facet.
struct GroupItem {
  Vec3f centroid;
  Vec3f normal;
  double area;
  float spread;             ///< mean squared distance of the facet's points from its centroid
  std::uint32_t cell;       ///< of the forest
  std::uint32_t direction;  ///< 2 * dominant axis of the normal, + 1 if it points down that axis

  GroupItem(const FacetForest& forest, std::uint32_t cell_);
};

/// The best division of a set, from measure().
struct Division {
  enum class Rule {
    kHalves,  ///< all centroids and normals are equal: by order
    kAlong,   ///< at the mean of a coordinate
    kAside,   ///< the facets of one direction from the rest
  };
  double inertia = 0;  ///< Σ area·(|x−x̄|² + w²|n−n̄|²) over all points of the facets
  Rule rule = Rule::kHalves;
  std::size_t axis = 0;         ///< kAlong: 0..2 position, 3..5 normal
  double mean = 0, margin = 0;  ///< kAlong
  std::uint32_t direction = 0;  ///< kAside
};

/// `normal_scale` is w: the distance in metres that counts as much as a change of the unit normal
/// by 1. Facets that face opposite ways are set aside from each other first; otherwise the set is
/// divided along the coordinate of (x, w·n) with the greatest area-weighted variance. O(items).
Division measure(std::span<const GroupItem> items, double normal_scale);

/// Reorders at least two items into two non-empty parts and returns the first part's size.
/// O(items).
std::size_t divide(std::span<GroupItem> items, const Division& division);

}  // namespace relumbre
