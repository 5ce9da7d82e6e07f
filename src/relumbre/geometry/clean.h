/// Takes out of a mesh what light transport cannot use.
#pragma once

#include <cstdint>
#include <vector>

#include "relumbre/geometry/triangle_mesh.h"

namespace relumbre {

/// Coordinates beyond this (in metres) count as not finite: areas would leave float's range.
inline constexpr float kLargestCoordinate = 1e15F;

struct CleanReport {
  std::size_t non_finite = 0;       ///< triangles with a NaN, infinite or absurdly large coordinate
  std::size_t degenerate = 0;       ///< without a usable normal
  std::size_t duplicate = 0;        ///< of another triangle with the same three points
  std::vector<std::uint32_t> kept;  ///< former indices of the triangles that stay, ascending

  [[nodiscard]] std::size_t dropped() const { return non_finite + degenerate + duplicate; }
};

/// Drops unusable triangles and compacts the per-triangle arrays; the order stays, and so do all
/// vertices (non-finite ones that nothing uses any more move onto a vertex that is used).
///
/// Degenerate: the smallest height is below 2^-22 of the largest absolute coordinate of the three
/// corners (4 units of their rounding; 1 micron at 4 m), or the area below 1e-30 m².
/// Duplicate: a triangle all of whose reflecting sides another triangle has. A one-sided one may
/// have a twin that faces the other way: that is the back of a thin wall. The first of equals
/// stays, and a two-sided one rather than one-sided ones.
///
/// Throws ValueError for an index out of range and ShapeError for a per-triangle array that is
/// neither empty nor one entry a triangle; the mesh is then unchanged. Expected O(T); while it
/// runs, up to 32 bytes a vertex and 50 bytes a triangle.
CleanReport clean(TriangleMesh& mesh);

}  // namespace relumbre
