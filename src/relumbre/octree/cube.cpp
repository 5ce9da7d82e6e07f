#include "relumbre/octree/cube.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

std::int64_t snapped(double fraction) {
  constexpr double units = static_cast<double>(std::int64_t{1} << kGridBits);
  return std::llround(std::clamp(fraction, 0.0, 1.0) * units);
}

}  // namespace

GridPoint Cube::snap(const Vec3f& p) const {
  const Vec3d fraction = (Vec3d(p) - corner) / edge;
  return {snapped(fraction.x), snapped(fraction.y), snapped(fraction.z)};
}

Vec3d Cube::to_voxels(const Vec3d& p, unsigned depth) const {
  return (p - corner) * (std::ldexp(1.0, static_cast<int>(depth)) / edge);
}

Cube cube_around(const Box& box) {
  if (box.empty()) throw ValueError("the mesh is empty: there is nothing to put a cube around");
  const Vec3d lower(box.lower), upper(box.upper);
  if (!is_finite(lower) || !is_finite(upper))
    throw ValueError("the mesh has a vertex that is not finite");
  const double edge = max_component(upper - lower);
  if (!(edge > 0)) throw ValueError("the mesh is a single point: its cube would have no extent");
  return {(lower + upper) * 0.5 - Vec3d(edge * 0.5), edge};
}

}  // namespace relumbre
