/// What a ray needs before it can take a lane: see ray_lanes-inl.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "relumbre/octree/grid_ray.h"

namespace relumbre {

/// The cell along one axis, by the plane times alone: from the nearest guess on.
inline double cell_at(const GridRay& ray, std::size_t axis, double guess, double now, double edge) {
  const double o = ray.origin()[axis], inverse = ray.inverse()[axis];
  const bool is_down = (ray.sign_mask() >> axis & 1U) != 0;
  double cell = guess > 0 ? std::floor(std::min(guess, edge - 1)) : 0;  // NaN: 0
  const auto is_passed = [&](double plane) { return (plane - o) * inverse <= now; };
  // Above plane k if it is passed upwards, or not yet downwards.
  while (cell > 0 && is_passed(cell) == is_down) --cell;
  while (cell + 1 < edge && is_passed(cell + 1) != is_down) ++cell;
  return cell;
}

/// Whether rounding can be bounded by ray_lanes-inl.h: of a ray that starts within 2^20 cubes, and
/// whose plane times neither overflow nor underflow.
inline bool is_tame(const GridRay& ray, double edge) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double inverse = std::abs(ray.inverse()[axis]);
    if (!(std::abs(ray.origin()[axis]) <= 0x1p20 * edge)) return false;
    if (!(inverse >= 0x1p-300 && inverse <= 0x1p300) && std::isfinite(inverse)) return false;
  }
  return true;
}

}  // namespace relumbre
