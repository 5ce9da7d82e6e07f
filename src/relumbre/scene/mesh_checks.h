/// Slow, obvious checks of meshes, for tests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "relumbre/base/sampling.h"
#include "relumbre/scene/scene.h"

namespace relumbre {

/// Triangles of the object of that name.
inline std::vector<std::size_t> triangles_of(const Scene& scene, std::string_view object) {
  std::vector<std::size_t> chosen;
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t)
    if (scene.objects[scene.mesh.object[t]].name == object) chosen.push_back(t);
  return chosen;
}

/// By the divergence theorem: positive where the fronts of a closed surface face outward.
inline double signed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    volume +=
        dot(Vec3d(mesh.corner(t, 0)), cross(Vec3d(mesh.corner(t, 1)), Vec3d(mesh.corner(t, 2)))) /
        6;
  return volume;
}

inline double total_area(const TriangleMesh& mesh) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    area += length(Vec3d(mesh.scaled_normal(t))) / 2;
  return area;
}

/// Edges that are not run through once each way, comparing corners by position.
inline std::size_t unmatched_edges(const TriangleMesh& mesh) {
  std::map<std::array<float, 6>, std::array<int, 2>> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3f a = mesh.corner(t, i) + Vec3f(0.0F),
                  b = mesh.corner(t, (i + 1) % 3) + Vec3f(0.0F);
      const std::array<float, 6> forth{a.x, a.y, a.z, b.x, b.y, b.z};
      const std::array<float, 6> back{b.x, b.y, b.z, a.x, a.y, a.z};
      ++(forth < back ? edges[forth][0] : edges[back][1]);
    }
  std::size_t unmatched = 0;
  for (const auto& [edge, ways] : edges) unmatched += ways[0] == 1 && ways[1] == 1 ? 0 : 1;
  return unmatched;
}

struct BruteHit {
  std::size_t triangle;
  double t;
  bool back;
};

/// The nearest triangle on a ray, by trying all. Source: Möller and Trumbore 1997.
inline std::optional<BruteHit> brute_closest(const TriangleMesh& mesh, const Vec3d& origin,
                                             const Vec3d& direction) {
  std::optional<BruteHit> best;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vec3d a(mesh.corner(i, 0)), e1 = Vec3d(mesh.corner(i, 1)) - a,
                                      e2 = Vec3d(mesh.corner(i, 2)) - a;
    const Vec3d p = cross(direction, e2);
    const double det = dot(e1, p);
    if (det == 0) continue;
    const Vec3d s = origin - a;
    const double u = dot(s, p) / det;
    if (u < 0 || u > 1) continue;
    const Vec3d q = cross(s, e1);
    const double v = dot(direction, q) / det, t = dot(e2, q) / det;
    if (v < 0 || u + v > 1 || t <= 0 || (best && t >= best->t)) continue;
    best = BruteHit{i, t, det < 0};
  }
  return best;
}

/// Direction i of n, spread evenly over the sphere. Source: Vogel 1979 (golden-angle spiral).
inline Vec3d sphere_direction(int i, int n) {
  const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z), phi = 2.399963229728653 * i;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace relumbre
