/// The part of a triangle that lies in a box: how much of it, and where.
#pragma once

#include <array>

#include "relumbre/base/vec3.h"

namespace relumbre {

struct ClippedTriangle {
  double area = 0;
  Vec3d centroid;  ///< the mean of the corners where there is no area
};

/// Sutherland and Hodgman's clipping against the box's six planes.
ClippedTriangle clip_to_box(const std::array<Vec3d, 3>& triangle, const Vec3d& lower,
                            const Vec3d& upper);

}  // namespace relumbre
