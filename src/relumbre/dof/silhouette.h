/// Internal: the nearest silhouette of every pixel's surface, for the CPU and the GPU.
#pragma once

#include <cstddef>
#include <limits>

#include "relumbre/base/host_device.h"
#include "relumbre/dof/edge_map.h"

namespace relumbre {

/// The nearest silhouette of a pixel's own surface, and the circle of confusion of what is seen
/// past it.
struct Silhouette {
  float distance = std::numeric_limits<float>::infinity();
  float beyond = 0;
};

/// That of a pixel on the nearer side of a jump to one of the four beside it; others have none yet.
[[nodiscard]] RELUMBRE_HOST_DEVICE inline Silhouette own_silhouette(const EdgeMap& edges,
                                                                    std::ptrdiff_t x,
                                                                    std::ptrdiff_t y) {
  // From a pixel's centre to the nearest that may be seen past its edge.
  constexpr float kFirst = 1.0F;
  const CirclePlane& plane = edges.plane;
  Silhouette result;
  for (int side = 0; side < 4; ++side) {
    const int forward = side < 2 ? 1 : -1, dx = side % 2 == 0 ? forward : 0, dy = forward - dx;
    if (!edges.jump(x, y, dx, dy)) continue;
    const float there = plane.at(x + dx, y + dy);
    if (!(plane.at(x, y) < there)) continue;
    result.distance = kFirst;
    if (result.beyond < there) result.beyond = there;
  }
  return result;
}

/// What a pixel learns from those of its neighbours of the same surface that a sweep has passed:
/// from top to bottom and left to right (`step` = 1), or the other way (−1). After both, distances
/// are right within a tenth. Source: Borgefors 1986.
RELUMBRE_HOST_DEVICE inline void sweep_silhouette(const EdgeMap& edges, Silhouette* silhouettes,
                                                  std::ptrdiff_t x, std::ptrdiff_t y, int step) {
  constexpr float kSide = 1, kDiagonal = 1.3507F;
  const CirclePlane& plane = edges.plane;
  Silhouette here = silhouettes[y * plane.width + x];
  const auto from = [&](int dx, int dy, float cost) {
    const std::ptrdiff_t u = x + dx, v = y + dy;
    if (!plane.inside(u, v) || edges.jump(x, y, dx, dy)) return;
    const Silhouette there = silhouettes[v * plane.width + u];
    if (there.distance + cost < here.distance) here = {there.distance + cost, there.beyond};
  };
  from(-step, 0, kSide), from(0, -step, kSide);
  from(-1, -step, kDiagonal), from(1, -step, kDiagonal);
  silhouettes[y * plane.width + x] = here;
}

/// Whether a lens sees a pixel's hidden surface past the silhouette: `front` and `behind` are
/// circles of confusion, `depth` is that of what is hidden (0: not known).
[[nodiscard]] RELUMBRE_HOST_DEVICE inline bool is_revealed(const Silhouette& silhouette,
                                                           float depth, float front, float behind) {
  const bool known = depth > 0;
  const bool in_reach = silhouette.distance <= (behind - front) / 2;
  const bool in_sight = behind <= silhouette.beyond + kOneSurface;
  return known && in_reach && in_sight;
}

}  // namespace relumbre
