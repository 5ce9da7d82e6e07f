/// How a mesh is cut into facets, grouped into n elements, grouped into k patches.
///
/// Each reflecting side of a source triangle (front, and back where it is two-sided) is a *side*.
/// A side is the root of a quadtree of 4-way cuts; its leaves are *facets*. An *element* is one or
/// more facets and carries one radiosity; a *patch* is a run of elements.
///
///   side ──4-way cuts──► facets ──► element (n) ──► patch (k)
///
/// Everything is ordered by patch: the elements of patch p are [patch_offsets[p],
/// patch_offsets[p+1]), the facets of element i are [facet_offsets[i], facet_offsets[i+1]).
/// So Vᵀ of the radiosity operator is a sum over contiguous segments.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/triangle_mesh.h"

namespace relumbre {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A leaf of a side's quadtree. Corners are in the side's own orientation: counter-clockwise seen
/// from where it reflects.
struct Facet {
  Index3 corners;          ///< into Tessellation::positions
  std::uint32_t triangle;  ///< source triangle
  std::uint32_t back;      ///< 1 if it is the source triangle's back side
};

/// Finds the facet under a hit point. One quadtree a side, stored as blocks of four children.
///
///   root[2*triangle + side] ─► node ≥ 0: children at nodes[4*node + 0..3]
///                              node < 0: facet ~node
///
/// Children of a triangle (a, b, c) with midpoints: 0 = corner a, 1 = corner b, 2 = corner c,
/// 3 = the middle one (mid bc, mid ca, mid ab).
struct FacetLocator {
  std::vector<std::int32_t> roots;  ///< 2 per source triangle; kMissing where a side is absent
  std::vector<std::int32_t> nodes;  ///< 4 per inner node
  static constexpr std::int32_t kMissing = std::numeric_limits<std::int32_t>::max();
};

struct Tessellation {
  std::vector<Vec3f> positions;              ///< of facet corners; equal points share an index
  std::vector<Facet> facets;                 ///< sorted by element
  std::vector<std::uint32_t> facet_offsets;  ///< n + 1
  std::vector<std::uint32_t> patch_offsets;  ///< k + 1, in elements
  std::vector<float> area;                   ///< n, m²
  std::vector<Vec3f> centroid;               ///< n
  std::vector<Vec3f> normal;                 ///< n, unit, area-weighted mean of the facets'
  FacetLocator locator;

  [[nodiscard]] std::size_t elements() const { return area.size(); }
  [[nodiscard]] std::size_t patches() const {
    return patch_offsets.empty() ? 0 : patch_offsets.size() - 1;
  }
  [[nodiscard]] std::span<const Facet> facets_of(std::size_t element) const {
    return std::span(facets).subspan(facet_offsets[element],
                                     facet_offsets[element + 1] - facet_offsets[element]);
  }
  /// Facet under the point with source barycentrics (u, v) (weights of corners 1 and 2) on one side
  /// of a source triangle; kNone where that side does not reflect. O(depth of the cuts).
  [[nodiscard]] std::uint32_t locate(std::uint32_t triangle, bool back, float u, float v) const;
  /// facet -> element, element -> patch, as flat tables.
  [[nodiscard]] std::vector<std::uint32_t> element_of_facet() const;
  [[nodiscard]] std::vector<std::uint32_t> patch_of_element() const;
};

enum class PatchMethod {
  kHierarchy,  ///< the paper's two levels: 4-way cuts only; k = T + 3j times 4^i, n = k·4^i
  kCluster,    ///< large triangles cut, small ones clustered by position and normal; any k ≤ n
};

struct TessellationConfig {
  std::size_t patches = 216;    ///< k
  std::size_t elements = 3456;  ///< n ≥ k
  PatchMethod method = PatchMethod::kCluster;
  /// Triangles with the same label other than 0 get patches of their own (emissive surfaces).
  std::span<const std::uint32_t> separate = {};  ///< empty, or one per triangle
};

/// Cuts and clusters `mesh` into exactly config.elements elements and config.patches patches.
/// Deterministic. kHierarchy: the largest triangle is cut 4-way until there are k₀ patches, where
/// k₀ is k divided by 4 while it stays at least 6 a side; then all are cut again until there are k
/// (216 = 36 + 3·60; 864 and 3,456 from 216, as in the paper, §4).
/// kCluster: starting from one group a label, the group with the largest inertia
/// Σ area·(|x−x̄|² + w²|n−n̄|²) is split in two until there are k (patches), then n (elements); a
/// group of a single facet is first cut 4-way. w = 2√(total area / k), then with n for k. Facets
/// whose normals have opposite dominant axes are set aside from each other whenever their group is
/// split. Source of the two-level scheme: Fernández 2009; see docs/references.bib. Throws
/// ValueError naming the figures if k or n cannot be reached (k > n; k below the number of labels;
/// not of the hierarchy's form; n above 2^27; float's resolution forbids more cuts), for an empty
/// mesh, and for a triangle without a finite positive area (see clean.h); ShapeError if separate or
/// two_sided do not fit the mesh. O(N log N) for N = sides + n.
Tessellation tessellate(const TriangleMesh& mesh, const TessellationConfig& config);

}  // namespace relumbre
