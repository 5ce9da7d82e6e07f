/// Rays that wait for a lane: what a lane needs to know of a ray, side by side.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "relumbre/octree/tree_cast.h"

namespace relumbre {

struct alignas(64) RayQueue {
  static constexpr std::size_t kCapacity = 128;
  using Numbers = std::array<double, kCapacity>;

  std::array<Numbers, 3> origin, inverse, slope;  ///< slope: the direction, 0 if parallel
  std::array<Numbers, 3> cell;                    ///< that the ray is in at `now`
  Numbers now, end;
  Numbers doubt;  ///< how near to a plane a point of the ray is on an unknown side of it
  std::array<std::uint64_t, kCapacity> ray;
  std::size_t size = 0;
};

namespace ray_queue_detail {

/// The cell along one axis, by the plane times alone: from the nearest guess on.
inline double cell_at(const GridRay& ray, std::size_t axis, double guess, double now, double edge) {
  const double o = ray.origin()[axis], inverse = ray.inverse()[axis];
  const bool is_down = (ray.sign_mask() >> axis & 1U) != 0;
  double cell = std::fmin(std::fmax(std::floor(guess), 0), edge - 1);  // NaN becomes 0
  const auto is_passed = [&](double plane) { return (plane - o) * inverse <= now; };
  // Above plane k if it is passed upwards, or not yet downwards.
  while (cell > 0 && is_passed(cell) == is_down) --cell;
  while (cell + 1 < edge && is_passed(cell + 1) != is_down) ++cell;
  return cell;
}

}  // namespace ray_queue_detail

/// Whether rounding can be bounded by `doubt`: of a ray that starts within 2^20 cubes, and whose
/// plane times neither overflow nor underflow.
inline bool is_tame(const GridRay& ray, double edge) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double inverse = std::abs(ray.inverse()[axis]);
    if (!(std::abs(ray.origin()[axis]) <= 0x1p20 * edge)) return false;
    if (!(inverse >= 0x1p-300 && inverse <= 0x1p300) && std::isfinite(inverse)) return false;
  }
  return true;
}

/// A tame ray that pierces the cube.
inline void push(RayQueue& queue, std::uint64_t index, const GridRay& ray, const Vec3d& direction,
                 double now, double end, double edge) {
  const std::size_t i = queue.size++;
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double o = ray.origin()[axis];
    const double slope = std::isfinite(ray.inverse()[axis]) ? direction[axis] : 0;
    queue.origin[axis][i] = o;
    queue.inverse[axis][i] = ray.inverse()[axis];
    queue.slope[axis][i] = slope;
    queue.cell[axis][i] = ray_queue_detail::cell_at(ray, axis, o + slope * now, now, edge);
    largest = std::fmax(largest, std::abs(o));
  }
  queue.now[i] = now, queue.end[i] = end;
  queue.doubt[i] = 0x1p-48 * (largest + edge);
  queue.ray[i] = index;
}

}  // namespace relumbre
