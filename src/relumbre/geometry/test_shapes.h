/// Small meshes for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "relumbre/base/sampling.h"
#include "relumbre/geometry/triangle_mesh.h"

namespace relumbre::shapes {

/// Appends a triangle with vertices of its own.
inline void add_triangle(TriangleMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c,
                         bool two_sided = false) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.material.push_back(0);
  mesh.object.push_back(0);
  mesh.two_sided.push_back(two_sided ? 1 : 0);
}

/// Appends the parallelogram at `corner` that faces edge1 × edge2, as two triangles.
inline void add_quad(TriangleMesh& mesh, const Vec3f& corner, const Vec3f& edge1,
                     const Vec3f& edge2, bool two_sided = false) {
  const Vec3f opposite = corner + edge1 + edge2;
  add_triangle(mesh, corner, corner + edge1, opposite, two_sided);
  add_triangle(mesh, corner, opposite, corner + edge2, two_sided);
}

/// Appends the 12 triangles of an axis-aligned box, facing out or in.
inline void add_box(TriangleMesh& mesh, const Vec3f& lower, const Vec3f& upper, bool inward) {
  const Vec3f size = upper - lower;
  const Vec3f x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  const auto face = [&](const Vec3f& corner, const Vec3f& e1, const Vec3f& e2) {
    inward ? add_quad(mesh, corner, e2, e1) : add_quad(mesh, corner, e1, e2);
  };
  face(lower, y, x), face(lower, z, y), face(lower, x, z);
  face(upper, -x, -y), face(upper, -y, -z), face(upper, -z, -x);
}

/// A room with two blocks: 36 triangles, as in Fernández 2009.
inline TriangleMesh blocks_in_room() {
  TriangleMesh mesh;
  add_box(mesh, {0, 0, 0}, {5.5F, 5.5F, 5.6F}, true);
  add_box(mesh, {0.8F, 0, 0.7F}, {2.4F, 1.65F, 2.3F}, false);
  add_box(mesh, {3.1F, 0, 2.5F}, {4.7F, 3.3F, 4.1F}, false);
  return mesh;
}

/// A sphere of `rings` bands from pole to pole and 4 · rings · (rings - 1) triangles, facing out.
inline TriangleMesh sphere(std::uint32_t rings, const Vec3f& center = {}, float radius = 1) {
  TriangleMesh mesh;
  const auto point = [&](std::uint32_t i, std::uint32_t j) {
    const double theta = std::numbers::pi * i / rings;
    const double phi = std::numbers::pi * (j % (2 * rings)) / rings;
    const double around = i == 0 || i == rings ? 0 : std::sin(theta);  // poles are one point
    const Vec3d unit{around * std::cos(phi), std::cos(theta), -around * std::sin(phi)};
    return center + Vec3f(unit) * radius;
  };
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < 2 * rings; ++j) {
      if (i > 0) add_triangle(mesh, point(i, j), point(i + 1, j), point(i, j + 1));
      if (i + 1 < rings) add_triangle(mesh, point(i, j + 1), point(i + 1, j), point(i + 1, j + 1));
    }
  }
  return mesh;
}

/// Random triangles of very different sizes in the unit cube, some two-sided.
inline TriangleMesh soup(std::size_t triangles, std::uint64_t seed) {
  TriangleMesh mesh;
  RandomStream random(seed);
  const auto point = [&] { return Vec3f{random.uniform(), random.uniform(), random.uniform()}; };
  for (std::size_t t = 0; t < triangles; ++t) {
    const float size = std::pow(0.5F, 8 * random.uniform());
    const Vec3f at = point();
    add_triangle(mesh, at + point() * size, at + point() * size, at + point() * size, t % 3 == 0);
  }
  return mesh;
}

}  // namespace relumbre::shapes
