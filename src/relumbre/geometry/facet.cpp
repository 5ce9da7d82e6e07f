#include "relumbre/geometry/facet.h"

#include <utility>

#include "relumbre/geometry/descend.h"

namespace relumbre {
namespace {

struct Barycentrics {
  double u, v;
};

/// Of the point of the triangle's plane nearest to p. Source: Ericson 2005, §3.4.
Barycentrics project(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3d& p) {
  const Vec3d a(mesh.corner(triangle, 0));
  const Vec3d e1 = Vec3d(mesh.corner(triangle, 1)) - a, e2 = Vec3d(mesh.corner(triangle, 2)) - a;
  const Vec3d n = cross(e1, e2), q = p - a;
  const double squared = dot(n, n);
  return {dot(cross(q, e2), n) / squared, dot(cross(e1, q), n) / squared};
}

using Corners = std::array<Vec2f, 3>;

/// Corners of a child, numbered as in FacetLocator.
Corners child_corners(const Corners& parent, std::size_t child) {
  const auto& [a, b, c] = parent;
  const Vec2f bc = (b + c) * 0.5F, ca = (c + a) * 0.5F, ab = (a + b) * 0.5F;
  switch (child) {
    case 0:
      return {a, ab, ca};
    case 1:
      return {ab, b, bc};
    case 2:
      return {ca, bc, c};
    default:
      return {bc, ca, ab};
  }
}

Corners swapped(const Corners& corners) {
  return {Vec2f{corners[0].y, corners[0].x}, Vec2f{corners[1].y, corners[1].x},
          Vec2f{corners[2].y, corners[2].x}};
}

/// For facets so small that rounding puts their centroid into a neighbour.
Corners project_corners(const TriangleMesh& mesh, const Facet& facet, const Tessellation& t) {
  Corners corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [u, v] = project(mesh, facet.triangle, Vec3d(t.positions[facet.corners[i]]));
    corners[i] = {static_cast<float>(u), static_cast<float>(v)};
  }
  return corners;
}

}  // namespace

FacetPoint locate_point(const FacetLocator& locator, std::uint32_t triangle, bool back, float u,
                        float v) {
  const std::int32_t root = locator.roots[2 * std::size_t{triangle} + (back ? 1 : 0)];
  if (root == FacetLocator::kMissing) return {};
  if (back) std::swap(u, v);
  const std::int32_t leaf = descend(locator.nodes.data(), root, u, v);
  return {static_cast<std::uint32_t>(~leaf), u, v};
}

std::array<Vec2f, 3> facet_barycentrics(const TriangleMesh& mesh, const Facet& facet,
                                        const Tessellation& tessellation) {
  const auto& [roots, nodes] = tessellation.locator;
  const auto& points = tessellation.positions;
  const auto [a, b, c] = facet.corners;
  auto [u, v] =
      project(mesh, facet.triangle, (Vec3d(points[a]) + Vec3d(points[b]) + Vec3d(points[c])) / 3.0);
  if (facet.back != 0) std::swap(u, v);
  // Walk to the facet by its centroid, carrying the exact corners along.
  Corners corners{Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{0, 1}};
  std::int32_t node = roots[2 * std::size_t{facet.triangle} + facet.back];
  while (node >= 0) {
    const std::size_t child = enter_child(u, v);
    corners = child_corners(corners, child);
    node = nodes[4 * static_cast<std::size_t>(node) + child];
  }
  const Facet& reached = tessellation.facets[static_cast<std::uint32_t>(~node)];
  if (reached.corners != facet.corners) return project_corners(mesh, facet, tessellation);
  return facet.back != 0 ? swapped(corners) : corners;
}

}  // namespace relumbre
