/// Polygons as triangles.
#pragma once

#include <span>
#include <vector>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// Cuts a simple polygon, convex or not and nearly planar, into corners.size() − 2 triangles that
/// keep its orientation, as indices into `corners`, appended to `triangles`. Polygons that cross
/// themselves or have corners that are not finite are cut somehow, into as many triangles. O(n) for
/// triangles and quadrilaterals, O(n²) to O(n³) for more corners; beyond 256 of them a fan.
/// Source: ear clipping, Meisters 1975, "Polygons Have Ears".
void triangulate_polygon(std::span<const Vec3f> corners, std::vector<Index3>& triangles);

}  // namespace relumbre
