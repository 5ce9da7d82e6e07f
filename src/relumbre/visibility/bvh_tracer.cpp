#include "relumbre/visibility/bvh_tracer.h"

#include <algorithm>
#include <array>

namespace relumbre {

namespace {

inline void closest_of(const BvhView& scene, std::span<const BvhRay> rays, std::span<BvhHit> hits) {
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = trace<false>(scene, rays[i]);
}

inline void occluded_of(const BvhView& scene, std::span<const BvhRay> rays,
                        std::span<std::uint8_t> blocked) {
  for (std::size_t i = 0; i < rays.size(); ++i) blocked[i] = trace<true>(scene, rays[i]).hit();
}

// Without the instruction a fused multiply-add is a call. The bits are the same.
#if defined(__x86_64__)
bool has_fma() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

[[gnu::target("avx2,fma,bmi,bmi2,lzcnt,popcnt"), gnu::flatten]] void closest_by_fma(
    const BvhView& scene, std::span<const BvhRay> rays, std::span<BvhHit> hits) {
  closest_of(scene, rays, hits);
}
[[gnu::target("avx2,fma,bmi,bmi2,lzcnt,popcnt"), gnu::flatten]] void occluded_by_fma(
    const BvhView& scene, std::span<const BvhRay> rays, std::span<std::uint8_t> blocked) {
  occluded_of(scene, rays, blocked);
}
#else
constexpr bool has_fma() { return false; }
constexpr auto closest_by_fma = closest_of;
constexpr auto occluded_by_fma = occluded_of;
#endif

constexpr std::size_t kAtOnce = 64;

/// Calls visit(first, rays) on a few converted rays after the other.
template <class Visit>
void in_portions(std::span<const Ray> rays, Visit&& visit) {
  std::array<BvhRay, kAtOnce> portion;
  for (std::size_t first = 0; first < rays.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, rays.size() - first);
    for (std::size_t i = 0; i < count; ++i) portion[i] = to_bvh(rays[first + i]);
    visit(first, std::span<const BvhRay>(portion).first(count));
  }
}

}  // namespace

BvhRay to_bvh(const Ray& ray) {
  return {ray.origin.x,    ray.origin.y,    ray.origin.z,    ray.t_min,
          ray.direction.x, ray.direction.y, ray.direction.z, ray.t_max};
}

Hit from_bvh(const BvhHit& hit) {
  if (!hit.hit()) return {};
  return {hit.triangle(), hit.t, hit.u, hit.v, hit.back()};
}

void trace_closest(const BvhView& scene, std::span<const BvhRay> rays, std::span<BvhHit> hits) {
  has_fma() ? closest_by_fma(scene, rays, hits) : closest_of(scene, rays, hits);
}

void trace_occluded(const BvhView& scene, std::span<const BvhRay> rays,
                    std::span<std::uint8_t> blocked) {
  has_fma() ? occluded_by_fma(scene, rays, blocked) : occluded_of(scene, rays, blocked);
}

Hit BvhTracer::closest(const Ray& ray) const {
  Hit hit;
  closest({&ray, 1}, {&hit, 1});
  return hit;
}

bool BvhTracer::occluded(const Ray& ray) const {
  std::uint8_t blocked = 0;
  occluded({&ray, 1}, {&blocked, 1});
  return blocked != 0;
}

void BvhTracer::closest(std::span<const Ray> rays, std::span<Hit> hits) const {
  in_portions(rays, [&](std::size_t first, std::span<const BvhRay> portion) {
    std::array<BvhHit, kAtOnce> met;
    trace_closest(view(), portion, std::span(met).first(portion.size()));
    for (std::size_t i = 0; i < portion.size(); ++i) hits[first + i] = from_bvh(met[i]);
  });
}

void BvhTracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
  in_portions(rays, [&](std::size_t first, std::span<const BvhRay> portion) {
    trace_occluded(view(), portion, blocked.subspan(first, portion.size()));
  });
}

void BvhTracer::closest(const RayPacket& rays, HitPacket& hits, std::size_t active) const {
  active = std::min(active, RayPacket::kSize);
  std::array<Ray, RayPacket::kSize> lanes;
  std::array<Hit, RayPacket::kSize> met{};
  for (std::size_t i = 0; i < active; ++i) {
    lanes[i] = {{rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
                rays.t_min[i],
                {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]},
                rays.t_max[i]};
  }
  closest(std::span<const Ray>(lanes).first(active), std::span(met).first(active));
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    hits.triangle[i] = met[i].triangle, hits.back[i] = met[i].back ? 1 : 0;
    hits.t[i] = met[i].t, hits.u[i] = met[i].u, hits.v[i] = met[i].v;
  }
}

}  // namespace relumbre
