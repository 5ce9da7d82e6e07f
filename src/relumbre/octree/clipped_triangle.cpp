#include "relumbre/octree/clipped_triangle.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace relumbre {

namespace {

/// A convex polygon; every one of six planes may add a corner to a triangle.
struct Polygon {
  std::array<Vec3d, 9> corner;
  std::size_t size = 0;
  void add(const Vec3d& p) { corner[size++] = p; }
};

/// A side of the box: sign · (p[axis] - at) ≤ 0. The axis is known when it is compiled: this is
/// where voxelisation with colours spends its time.
template <std::size_t kAxis>
struct Plane {
  double at, sign;
  [[nodiscard]] double outside(const Vec3d& p) const { return sign * (p[kAxis] - at); }
};

template <std::size_t kAxis>
void clip(const Polygon& polygon, const Plane<kAxis>& plane, Polygon& result) {
  result.size = 0;
  const Vec3d* a = &polygon.corner[polygon.size - 1];
  double outside_a = plane.outside(*a);
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Vec3d* b = &polygon.corner[i];
    const double outside_b = plane.outside(*b);
    if ((outside_a < 0 && outside_b > 0) || (outside_a > 0 && outside_b < 0)) {
      Vec3d p = *a + (*b - *a) * (outside_a / (outside_a - outside_b));
      p[kAxis] = plane.at;
      result.add(p);
    }
    if (outside_b <= 0) result.add(*b);
    a = b, outside_a = outside_b;
  }
}

template <std::size_t kAxis>
bool is_inside(const Polygon& polygon, const Plane<kAxis>& plane) {
  return std::all_of(polygon.corner.begin(),
                     polygon.corner.begin() + static_cast<std::ptrdiff_t>(polygon.size),
                     [&](const Vec3d& p) { return plane.outside(p) <= 0; });
}

/// Between both sides along an axis; the polygon may change places with the spare one.
template <std::size_t kAxis>
void clip_to_slab(Polygon*& polygon, Polygon*& spare, const Vec3d& lower, const Vec3d& upper) {
  for (const auto& plane : {Plane<kAxis>{lower[kAxis], -1}, Plane<kAxis>{upper[kAxis], 1}}) {
    if (polygon->size == 0 || is_inside(*polygon, plane)) continue;
    clip(*polygon, plane, *spare);
    std::swap(polygon, spare);
  }
}

/// By the fan of triangles around the first corner.
ClippedTriangle measured(const Polygon& polygon) {
  ClippedTriangle result;
  Vec3d moment, mean;
  for (std::size_t i = 0; i < polygon.size; ++i)
    mean += polygon.corner[i] / static_cast<double>(polygon.size);
  const Vec3d& o = polygon.corner[0];
  for (std::size_t i = 2; i < polygon.size; ++i) {
    const Vec3d &a = polygon.corner[i - 1], &b = polygon.corner[i];
    const double area = length(cross(a - o, b - o)) / 2;
    result.area += area;
    moment += (o + a + b) * (area / 3);
  }
  result.centroid = result.area > 0 ? moment / result.area : mean;
  return result;
}

}  // namespace

ClippedTriangle clip_to_box(const std::array<Vec3d, 3>& triangle, const Vec3d& lower,
                            const Vec3d& upper) {
  Polygon one, other;
  for (const Vec3d& p : triangle) one.add(p);
  Polygon *polygon = &one, *spare = &other;
  clip_to_slab<0>(polygon, spare, lower, upper);
  clip_to_slab<1>(polygon, spare, lower, upper);
  clip_to_slab<2>(polygon, spare, lower, upper);
  if (polygon->size > 0) return measured(*polygon);
  return {0, min(max((triangle[0] + triangle[1] + triangle[2]) / 3.0, lower), upper)};
}

}  // namespace relumbre
