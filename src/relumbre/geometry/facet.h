/// Points on facets: between a source triangle's barycentrics and a facet's.
#pragma once

#include <array>
#include <cstdint>

#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/triangle_mesh.h"

namespace relumbre {

/// A point of a facet; u and v weigh the facet's corners 1 and 2.
struct FacetPoint {
  std::uint32_t facet = kNone;
  float u = 0, v = 0;
};

/// Facet and place in it of the point with source barycentrics (u, v) on one side of a source
/// triangle; facet is kNone where that side does not reflect. O(depth of the cuts).
FacetPoint locate_point(const FacetLocator& locator, std::uint32_t triangle, bool back, float u,
                        float v);

/// Barycentrics (weights of the source triangle's corners 1 and 2) of a facet's three corners: what
/// interpolates texture coordinates over it. `facet` is one of tessellation.facets, and `mesh` what
/// was tessellated. Exact multiples of 2^-depth. O(depth of the cuts).
std::array<Vec2f, 3> facet_barycentrics(const TriangleMesh& mesh, const Facet& facet,
                                        const Tessellation& tessellation);

}  // namespace relumbre
