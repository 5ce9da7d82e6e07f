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

/// Silhouettes of columns [x, x + width) and rows [y, y + height) of a picture. Distances of up to
/// d are those of the whole picture where the window goes on for d pixels or to the border: nothing
/// farther away has a say in them.
struct SilhouetteWindow {
  EdgeMap edges;
  std::ptrdiff_t x, y, width, height;
  Silhouette* at;  ///< row by row

  [[nodiscard]] RELUMBRE_HOST_DEVICE Silhouette& of(std::ptrdiff_t u, std::ptrdiff_t v) const {
    return at[v * width + u];
  }
  RELUMBRE_HOST_DEVICE void begin(std::ptrdiff_t u, std::ptrdiff_t v) const {
    of(u, v) = own_silhouette(edges, x + u, y + v);
  }
  /// What pixel (u, v) of the window learns from those of its neighbours of the same surface that a
  /// sweep has passed: from top to bottom and left to right (`step` = 1), or the other way (−1).
  /// After both, distances are right within a tenth. Source: Borgefors 1986.
  RELUMBRE_HOST_DEVICE void sweep(std::ptrdiff_t u, std::ptrdiff_t v, int step) const {
    constexpr float kSide = 1, kDiagonal = 1.3507F;
    Silhouette here = of(u, v);
    const auto from = [&](int dx, int dy, float cost) {
      const bool inside = u + dx >= 0 && u + dx < width && v + dy >= 0 && v + dy < height;
      if (!inside || edges.jump(x + u, y + v, dx, dy)) return;
      const Silhouette there = of(u + dx, v + dy);
      if (there.distance + cost < here.distance) here = {there.distance + cost, there.beyond};
    };
    from(-step, 0, kSide), from(0, -step, kSide);
    from(-1, -step, kDiagonal), from(1, -step, kDiagonal);
    of(u, v) = here;
  }
};

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
