/// The blurs that a picture in layers has, and how fragments are shared out among them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "relumbre/base/host_device.h"

namespace relumbre {

/// Signed diameters, from the least to the largest, all different: those two, 0 if it lies between
/// them, and others between at which the box of `box_radius_of` has a whole radius. They are about
/// as far apart as equal steps of asinh(diameter / 8), so that steps near the plane in focus are of
/// one pixel in radius and those of large blurs are even shares of their size. At most steps + 2;
/// one if least = largest. Throws ValueError for 0 steps.
std::vector<float> blur_steps(float least, float largest, std::size_t steps);

/// Radius of the square of side 2r + 1 that has the area of a disc of this diameter; 0 where it is
/// smaller than a pixel.
float box_radius_of(float signed_diameter);

/// Radius of the square 2r + 1 pixels wide whose side is a circle of confusion's diameter.
RELUMBRE_HOST_DEVICE inline float box_radius(float signed_diameter) {
  return std::max((std::abs(signed_diameter) - 1) / 2, 0.0F);
}

/// How much of what has this circle of confusion belongs to the farther of two steps; the nearer
/// has the rest. The shares of all steps add up to 1.
RELUMBRE_HOST_DEVICE inline float share_of_next(float coc, float step, float next) {
  return (coc - step) / (next - step);
}

}  // namespace relumbre
