/// From low-discrepancy points to rays, one at a time, on CPU and GPU: the maps of ray_generator.h
/// in the same order of operations.
#pragma once

#include <array>
#include <cstdint>

#include "relumbre/base/device_math.h"
#include "relumbre/base/host_device.h"
#include "relumbre/base/sampling.h"

namespace relumbre {

/// What makes one element's rays its own: each coordinate of the pattern is XORed with a constant.
using DigitalShift = std::array<std::uint32_t, 4>;

inline DigitalShift digital_shift(std::uint64_t seed, std::uint64_t stream) {
  const std::uint64_t low = hash64(seed, stream), high = hash64(low);
  return {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(low >> 32),
          static_cast<std::uint32_t>(high), static_cast<std::uint32_t>(high >> 32)};
}

namespace ray_maps {

struct Direction {
  float x, y, z;
};

/// A point of the pattern: two numbers that choose where a ray starts, two its direction.
struct Point {
  float x, y, u, v;
};

/// 32 bits to the middle of one of 2^23 cells of (0, 1).
RELUMBRE_HOST_DEVICE inline float to_cell(std::uint32_t bits) {
  return float_of_bits((bits >> 9) | 0x3F800000U) - (1.0F - 0x1p-24F);
}

/// Unit square to the cosine hemisphere about +z. Source: Shirley and Chiu 1997.
RELUMBRE_HOST_DEVICE inline Direction cosine_hemisphere(float u, float v) {
  const float a = fused(2, u, -1), b = fused(2, v, -1);
  const bool wide = ::fabsf(a) > ::fabsf(b);
  const float radius = wide ? a : b, other = wide ? b : a;
  const float angle = other / radius * 0.785398163397448F;  // π/4
  const float square = angle * angle;
  float s = fused(1 / 362880.0F, square, -1 / 5040.0F);
  s = fused(fused(fused(s, square, 1 / 120.0F), square, -1 / 6.0F), square, 1);
  float c = fused(1 / 40320.0F, square, -1 / 720.0F);
  c = fused(fused(fused(c, square, 1 / 24.0F), square, -0.5F), square, 1);
  s *= angle;
  return {radius * (wide ? c : s), radius * (wide ? s : c),
          ::sqrtf(larger(fused(-radius, radius, 1), 0))};
}

/// From the frame of a unit normal, that of base/vec3.h, to the world.
RELUMBRE_HOST_DEVICE inline Direction to_world(const Direction& n, const Direction& d) {
  const float sign = ::copysignf(1.0F, n.z);
  const float a = -(1.0F / (sign + n.z)), c = n.x * n.y * a;
  const float tx = fused(sign * n.x, n.x * a, 1), by = fused(n.y * n.y, a, sign);
  return {fused(d.x, tx, fused(d.y, c, d.z * n.x)), fused(d.x, sign * c, fused(d.y, by, d.z * n.y)),
          fused(d.x, -(sign * n.x), fused(-d.y, n.y, d.z * n.z))};
}

/// The facet j with cumulative[j] ≤ x < cumulative[j + 1] of `facets`, see EmittingSurface; x is
/// stretched over that facet's share.
RELUMBRE_HOST_DEVICE inline std::uint32_t choose_facet(const float* cumulative,
                                                       std::uint32_t facets, float& x) {
  if (facets < 2) return 0;
  std::uint32_t facet = 0;
  for (std::uint32_t step = 1U << highest_bit(facets - 1); step > 0; step /= 2) {
    if (facet + step < facets && x >= cumulative[facet + step]) facet += step;
  }
  x = (x - cumulative[facet]) / (cumulative[facet + 1] - cumulative[facet]);
  return facet;
}

}  // namespace ray_maps

/// A ray's start and direction.
struct ElementRay {
  float origin_x, origin_y, origin_z;
  float direction_x, direction_y, direction_z;
};

/// The ray of a point of the pattern, shifted already, from the facet whose record (see
/// EmittingSurface; aligned to 16 bytes) is given; x is what choose_facet() left of it.
/// Source of the map to the triangle: Heitz 2019.
RELUMBRE_HOST_DEVICE inline ElementRay element_ray(const float* record,
                                                   const ray_maps::Point& point) {
  using namespace ray_maps;
  const Words4 a = load_words(record), b = load_words(record + 4), c = load_words(record + 8);
  const Direction normal{float_of_bits(c.y), float_of_bits(c.z), float_of_bits(c.w)};
  const Direction direction = to_world(normal, cosine_hemisphere(point.u, point.v));
  const float fold = 0.5F * smaller(point.x, point.y);
  const float s = point.x - fold, t = point.y - fold;
  return {fused(s, float_of_bits(a.w), fused(t, float_of_bits(b.z), float_of_bits(a.x))),
          fused(s, float_of_bits(b.x), fused(t, float_of_bits(b.w), float_of_bits(a.y))),
          fused(s, float_of_bits(b.y), fused(t, float_of_bits(c.x), float_of_bits(a.z))),
          direction.x,
          direction.y,
          direction.z};
}

}  // namespace relumbre
