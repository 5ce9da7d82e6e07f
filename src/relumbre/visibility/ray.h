/// Rays and what they meet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {

struct Ray {
  Vec3f origin;
  float t_min = 0;
  Vec3f direction;  ///< need not have unit length; t is in units of it
  float t_max = std::numeric_limits<float>::infinity();
};

struct Hit {
  std::uint32_t triangle = kNone;  ///< kNone: the ray left the scene
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;  ///< barycentric weights of corners 1 and 2
  bool back = false;   ///< the ray met the back of the triangle
  explicit operator bool() const { return triangle != kNone; }
};

/// Sixteen rays side by side, the form in which the CPU traces them fastest.
///
///   origin    x0 x1 ... x15 | y0 y1 ... y15 | z0 z1 ... z15       directions likewise
struct alignas(64) RayPacket {
  static constexpr std::size_t kSize = 16;
  using Lanes = std::array<float, kSize>;
  std::array<Lanes, 3> origin;
  std::array<Lanes, 3> direction;
  Lanes t_min;
  Lanes t_max;
};

/// What sixteen rays met: the members of Hit, lane by lane.
struct alignas(64) HitPacket {
  std::array<std::uint32_t, RayPacket::kSize> triangle;  ///< kNone where the ray left the scene
  std::array<std::uint32_t, RayPacket::kSize> back;      ///< 1 where it met the back
  RayPacket::Lanes t, u, v;                              ///< only meaningful where it hit
};

}  // namespace relumbre
