/// The two definitions of a surface's voxels.
#pragma once

namespace relumbre {

/// Source: Schwarz and Seidel 2010, §4: a cell is covered if, for the plane of the triangle, its
/// bounding box and its projections along the three axes, the triangle meets
///   26-separating (conservative)  the cell's closed box: exactly the cells that it touches
///   6-separating (thin)           the octahedron inside it, whose corners are the faces' centres:
///                                 no path from face to face leads through the surface
enum class Separating { k6, k26 };

}  // namespace relumbre
