/// Low-discrepancy points and the maps from the unit square to triangles, discs and hemispheres.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// A well-mixed hash of 64 bits. Source: Steele et al. 2014, SplitMix64 finaliser.
constexpr std::uint64_t hash64(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}
constexpr std::uint64_t hash64(std::uint64_t a, std::uint64_t b) { return hash64(hash64(a) ^ b); }

/// 32 bits to [0, 1).
constexpr float to_unit(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * (1.0F / 16777216.0F);
}

/// A small random stream: one hash a draw. Seeds are hashed, so that neighbouring seeds (element
/// or pixel indices) give unrelated streams and not one stream shifted.
class RandomStream {
 public:
  explicit constexpr RandomStream(std::uint64_t seed) : state_(hash64(seed)) {}
  constexpr std::uint64_t bits() { return hash64(state_++); }
  constexpr float uniform() { return to_unit(static_cast<std::uint32_t>(bits() >> 32)); }

 private:
  std::uint64_t state_;
};

/// Point `index` of the four-dimensional Sobol' sequence as 32-bit fixed-point fractions. Any
/// aligned run of 2^m points is stratified. Source: Joe and Kuo 2008, direction numbers
/// new-joe-kuo-6.
std::array<std::uint32_t, 4> sobol4(std::uint32_t index);

/// Unit square to the triangle's first two barycentric coordinates, uniform in area.
/// Source: Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
constexpr Vec2f square_to_triangle(float u, float v) {
  if (v > u) {
    u *= 0.5F;
    v -= u;
  } else {
    v *= 0.5F;
    u -= v;
  }
  return {u, v};
}

/// Unit square to the unit disc, equal-area and concentric. Source: Shirley and Chiu 1997.
inline Vec2f square_to_disc(float u, float v) {
  const float a = 2 * u - 1, b = 2 * v - 1;
  if (a == 0 && b == 0) return {};
  constexpr float quarter = std::numbers::pi_v<float> / 4;
  const bool wide = std::abs(a) > std::abs(b);
  const float r = wide ? a : b;
  const float phi = wide ? quarter * (b / a) : 2 * quarter - quarter * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}

/// Unit square to the hemisphere about +z with density cos(theta)/pi.
inline Vec3f square_to_cosine_hemisphere(float u, float v) {
  const Vec2f d = square_to_disc(u, v);
  return {d.x, d.y, std::sqrt(std::max(0.0F, 1 - d.x * d.x - d.y * d.y))};
}

/// Unit square to the sphere, uniform in solid angle.
inline Vec3f square_to_sphere(float u, float v) {
  const float z = 1 - 2 * u, r = std::sqrt(std::max(0.0F, 1 - z * z));
  const float phi = 2 * std::numbers::pi_v<float> * v;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace relumbre
