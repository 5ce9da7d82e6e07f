/// A lit scene as a mesh with a colour at every vertex, for PLY and GLB.
#pragma once

#include <span>
#include <vector>

#include "relumbre/geometry/display.h"

namespace relumbre {

struct ColoredMesh {
  std::vector<Vec3f> positions;
  std::vector<Rgb> colors;  ///< one a position, in the unit of the values it was made from
  std::vector<Index3> triangles;
};

/// The fans of a display mesh, coloured as DisplayField interpolates `values` (n). Display vertices
/// come first, then a vertex at each facet's centroid. Throws ShapeError if there are not n values.
ColoredMesh colored_mesh(const Tessellation& tessellation, const DisplayMesh& display,
                         std::span<const Rgb> values);

}  // namespace relumbre
