#include "relumbre/render/probe_policy.h"

#include <algorithm>
#include <numbers>

namespace relumbre {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::size_t kMaxTriangles = 32;

/// Signed: above 0 as seen from the front. Source: Van Oosterom and Strackee 1983.
float signed_solid_angle(const Vec3f& p, const LightTriangle& t) {
  const Vec3f a = t.corners[0] - p, b = t.corners[1] - p, c = t.corners[2] - p;
  const float la = length(a), lb = length(b), lc = length(c);
  const float numerator = -dot(a, cross(b, c));
  const float denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * std::atan2(numerator, denominator);
}

}  // namespace

ProbePolicy::ProbePolicy(std::span<const LightTriangle> triangles) {
  for (const LightTriangle& t : triangles) {
    for (const Vec3f& corner : t.corners) box_.extend(corner);
    area_ += length(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) / 2;
  }
  if (triangles.size() <= kMaxTriangles) triangles_.assign(triangles.begin(), triangles.end());
}

float ProbePolicy::share(const Receiver& x) const {
  const Vec3f d = max(max(box_.lower - x.origin, x.origin - box_.upper), Vec3f{});
  if (dot(d, d) * kPi >= 4 * area_) return 0;
  return solid_angle(x) >= kPi ? 1.0F : 0.5F;
}

float ProbePolicy::solid_angle(const Receiver& x) const {
  float total = 0;
  for (const LightTriangle& t : triangles_) {
    const bool in_front = std::ranges::any_of(
        t.corners, [&](const Vec3f& c) { return dot(c - x.origin, x.normal) > 0; });
    if (!in_front) continue;
    const float angle = signed_solid_angle(x.origin, t);
    total += t.two_sided ? std::abs(angle) : std::max(angle, 0.0F);
  }
  return total;
}

}  // namespace relumbre
