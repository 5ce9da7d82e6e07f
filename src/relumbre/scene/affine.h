/// Affine maps of points, directions and normals, in double precision.
#pragma once

#include "relumbre/base/vec3.h"

namespace relumbre {

/// p ↦ x·p.x + y·p.y + z·p.z + t: the columns of a 3×4 matrix.
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{};

  [[nodiscard]] constexpr Vec3d vector(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
  [[nodiscard]] constexpr Vec3d point(const Vec3d& p) const { return vector(p) + t; }
  /// Negative where the map mirrors.
  [[nodiscard]] constexpr double determinant() const { return dot(x, cross(y, z)); }
  /// Along the image of a normal (the inverse transpose times a positive factor); not unit.
  [[nodiscard]] constexpr Vec3d normal(const Vec3d& n) const {
    const Vec3d cofactor = cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
    return determinant() < 0 ? -cofactor : cofactor;
  }
  /// (a * b) maps as b first, then a.
  friend constexpr Affine operator*(const Affine& a, const Affine& b) {
    return {a.vector(b.x), a.vector(b.y), a.vector(b.z), a.point(b.t)};
  }
};

}  // namespace relumbre
