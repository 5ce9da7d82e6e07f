#include "relumbre/render/primary_hits.h"

#include <algorithm>
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

/// Rays that no longer have neighbours: one at a time, unless the tracer wants many together.
void trace_apart(const RayScene& scene, std::span<const Ray> rays, std::span<Hit> hits) {
  if (scene.wants_long_batches()) return scene.closest(rays, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = scene.closest(rays[i]);
}

Ray lane(const RayPacket& packet, std::size_t i) {
  return {{packet.origin[0][i], packet.origin[1][i], packet.origin[2][i]},
          packet.t_min[i],
          {packet.direction[0][i], packet.direction[1][i], packet.direction[2][i]},
          packet.t_max[i]};
}

void set_lane(HitPacket& hits, std::size_t i, const Hit& hit) {
  hits.triangle[i] = hit.triangle;
  hits.back[i] = hit.back ? 1 : 0;
  hits.t[i] = hit.t, hits.u[i] = hit.u, hits.v[i] = hit.v;
}

/// A ray on its way through the surfaces behind its first hit.
struct Passage {
  std::size_t index;
  Ray ray;
  float depth;           ///< from where on a hit counts
  std::uint32_t object;  ///< that was hit first
  int inside = 0;        ///< solids of that object entered and not left
  Hit first_front{};     ///< the closest one that counts, inside a solid or not

  /// Takes note of a hit; true if it is what lies behind.
  bool meets(const Hit& hit, const TriangleMesh& mesh) {
    const bool one_sided = mesh.two_sided[hit.triangle] == 0;
    const bool same_object = mesh.object[hit.triangle] == object;
    if (one_sided && hit.back) {
      if (same_object) inside = std::max(0, inside - 1);
      return false;
    }
    const bool counts = hit.t > depth;
    if (counts && (!same_object || inside == 0)) return true;
    if (counts && !first_front) first_front = hit;
    if (same_object && one_sided) ++inside;
    return false;
  }
};

template <class T>
T interpolate(const std::vector<T>& values, const Index3& corners, float u, float v) {
  return values[corners[0]] * (1 - u - v) + values[corners[1]] * u + values[corners[2]] * v;
}

}  // namespace

void trace_primary(const Scene& scene, const RayScene& rays, std::span<const Ray> primary,
                   std::span<Hit> hits) {
  rays.closest(primary, hits);
  std::vector<std::size_t> left;
  std::vector<Ray> again;  // the rays of those
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!culled(scene, hits[i])) continue;
    left.push_back(i);
    again.push_back(primary[i]);
  }
  std::vector<Hit> met;
  for (int pass = 0; pass < kMaxBacks && !left.empty(); ++pass) {
    for (std::size_t i = 0; i < left.size(); ++i) {
      again[i] = behind(again[i], hits[left[i]], rays.epsilon());
    }
    met.assign(left.size(), {});
    trace_apart(rays, again, met);
    std::size_t still_left = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      hits[left[i]] = met[i];
      if (!culled(scene, met[i])) continue;
      again[still_left] = again[i];
      left[still_left++] = left[i];
    }
    left.resize(still_left), again.resize(still_left);
  }
  for (const std::size_t i : left) hits[i] = {};
}

void trace_primary(const Scene& scene, const RayScene& rays, const RayPacket& primary,
                   HitPacket& hits, std::size_t active) {
  rays.closest(primary, hits, active);
  for (std::size_t i = 0; i < active; ++i) {
    if (hits.triangle[i] == kNone || hits.back[i] == 0) continue;
    if (scene.mesh.two_sided[hits.triangle[i]] != 0) continue;
    const Ray ray = lane(primary, i);
    Hit hit;
    trace_primary(scene, rays, {&ray, 1}, {&hit, 1});
    set_lane(hits, i, hit);
  }
}

void trace_behind(const Scene& scene, const RayScene& rays, std::span<const Ray> primary,
                  std::span<const Hit> hits, float separation, std::span<Hit> behind_hits) {
  std::vector<Passage> passages;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    behind_hits[i] = {};
    if (!hits[i]) continue;
    const std::uint32_t triangle = hits[i].triangle;
    passages.push_back({i, behind(primary[i], hits[i], rays.epsilon()),
                        hits[i].t * (1 + separation), scene.mesh.object[triangle],
                        scene.mesh.two_sided[triangle] == 0 ? 1 : 0});
  }
  std::vector<Ray> batch;
  std::vector<Hit> met;
  for (int pass = 0; pass < kMaxBacks && !passages.empty(); ++pass) {
    batch.clear();
    for (const Passage& p : passages) batch.push_back(p.ray);
    met.assign(batch.size(), {});
    rays.closest(batch, met);
    std::size_t left = 0;
    for (std::size_t i = 0; i < met.size(); ++i) {
      Passage p = passages[i];
      if (!met[i]) {
        if (p.inside > 0) behind_hits[p.index] = p.first_front;
        continue;
      }
      if (p.meets(met[i], scene.mesh)) {
        behind_hits[p.index] = met[i];
        continue;
      }
      p.ray = behind(p.ray, met[i], rays.epsilon());
      passages[left++] = p;
    }
    passages.resize(left);
  }
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
