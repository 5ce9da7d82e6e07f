/// The two ways to make elements and patches out of a forest's leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "relumbre/geometry/facet_forest.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {

/// Which leaves form an element and which elements a patch, all in order.
struct Grouping {
  std::vector<std::uint32_t> leaves;         ///< cells of the forest, sorted by element
  std::vector<std::uint32_t> facet_offsets;  ///< n + 1, into leaves
  std::vector<std::uint32_t> patch_offsets;  ///< k + 1, in elements
};

/// The paper's hierarchy (Fernández 2009, §4): 4-way cuts only. See PatchMethod::kHierarchy.
/// The elements of a patch have exactly equal areas. Throws ValueError, naming the nearest figures
/// that are possible.
Grouping group_by_hierarchy(FacetForest& forest, const TessellationConfig& config);

/// Clusters that split where they are largest. See PatchMethod::kCluster. Throws ValueError.
Grouping group_by_clusters(FacetForest& forest, const TessellationConfig& config);

}  // namespace relumbre
