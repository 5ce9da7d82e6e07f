#include "relumbre/render/primary_hits.h"

#include <cmath>
#include <vector>

namespace relumbre {

namespace {

constexpr int kMaxBacks = 64;

bool culled(const Scene& scene, const Hit& hit) {
  return hit && hit.back && scene.mesh.two_sided[hit.triangle] == 0;
}

/// The same ray from just behind a hit.
Ray behind(Ray ray, const Hit& hit, float epsilon) {
  ray.t_min = std::nextafter(hit.t + epsilon / length(ray.direction), INFINITY);
  return ray;
}

template <class T>
T interpolate(const std::vector<T>& values, const Index3& corners, float u, float v) {
  return values[corners[0]] * (1 - u - v) + values[corners[1]] * u + values[corners[2]] * v;
}

}  // namespace

void trace_primary(const Scene& scene, const RayScene& rays, std::span<const Ray> primary,
                   std::span<Hit> hits) {
  rays.closest(primary, hits);
  std::vector<std::size_t> left;
  std::vector<Ray> again(primary.begin(), primary.end());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (culled(scene, hits[i])) left.push_back(i);
  }
  for (int pass = 0; pass < kMaxBacks && !left.empty(); ++pass) {
    std::vector<std::size_t> still_left;
    for (const std::size_t i : left) {
      again[i] = behind(again[i], hits[i], rays.epsilon());
      hits[i] = rays.closest(again[i]);
      if (culled(scene, hits[i])) still_left.push_back(i);
    }
    left = std::move(still_left);
  }
  for (const std::size_t i : left) hits[i] = {};
}

Surface surface_at(const Scene& scene, const Hit& hit) {
  const TriangleMesh& mesh = scene.mesh;
  const Index3& corners = mesh.triangles[hit.triangle];
  const float side = hit.back ? -1.0F : 1.0F;
  Surface surface;
  surface.position = interpolate(mesh.positions, corners, hit.u, hit.v);
  surface.normal = normalized(mesh.scaled_normal(hit.triangle)) * side;
  surface.shading_normal = surface.normal;
  surface.reflectance = scene.reflectance(hit.triangle, hit.u, hit.v);
  if (!scene.shading_normals.empty()) {
    const Vec3f smooth =
        normalized(interpolate(scene.shading_normals, corners, hit.u, hit.v)) * side;
    // Normals that point away from the surface are the file's mistake.
    if (dot(smooth, surface.normal) > 0) surface.shading_normal = smooth;
  }
  return surface;
}

}  // namespace relumbre
