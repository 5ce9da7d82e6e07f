#include "relumbre/dof/revealed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "relumbre/dof/surface_edges.h"

namespace relumbre {

namespace {

/// From a pixel's centre to the nearest that may be seen past its edge.
constexpr float kFirst = 1.0F;

/// kFirst on the nearer side of every silhouette, infinity elsewhere.
std::vector<float> silhouettes(std::span<const float> front, const SurfaceEdges& edges,
                               std::size_t width, std::size_t height) {
  std::vector<float> distance(front.size(), std::numeric_limits<float>::infinity());
  const auto compare = [&](std::size_t a, std::size_t b) {
    distance[front[a] < front[b] ? a : b] = kFirst;
  };
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      if (edges.jump(x, y, 1, 0)) compare(i, i + 1);
      if (edges.jump(x, y, 0, 1)) compare(i, i + width);
    }
  }
  return distance;
}

/// Distances to the nearest silhouette of the same surface by two sweeps over neighbours, within a
/// tenth (Borgefors 1986).
void spread_distances(const SurfaceEdges& edges, std::vector<float>& distance, std::size_t width,
                      std::size_t height) {
  constexpr float kSide = 1, kDiagonal = 1.3507F;
  const auto w = static_cast<std::ptrdiff_t>(width), h = static_cast<std::ptrdiff_t>(height);
  const auto sweep = [&](std::ptrdiff_t x, std::ptrdiff_t y, int step) {
    const auto from = [&](int dx, int dy, float cost) {
      const std::ptrdiff_t u = x + dx, v = y + dy;
      if (u < 0 || u >= w || v < 0 || v >= h) return;
      if (edges.jump(static_cast<std::size_t>(x), static_cast<std::size_t>(y), dx, dy)) return;
      float& here = distance[static_cast<std::size_t>(y * w + x)];
      here = std::min(here, distance[static_cast<std::size_t>(v * w + u)] + cost);
    };
    from(-step, 0, kSide), from(0, -step, kSide);
    from(-1, -step, kDiagonal), from(1, -step, kDiagonal);
  };
  for (std::ptrdiff_t y = 0; y < h; ++y)
    for (std::ptrdiff_t x = 0; x < w; ++x) sweep(x, y, 1);
  for (std::ptrdiff_t y = h - 1; y >= 0; --y)
    for (std::ptrdiff_t x = w - 1; x >= 0; --x) sweep(x, y, -1);
}

}  // namespace

std::vector<std::uint8_t> revealed(const DepthPicture& picture, std::span<const float> front,
                                   std::span<const float> behind) {
  const SurfaceEdges edges(front, picture.width, picture.height);
  std::vector<float> distance = silhouettes(front, edges, picture.width, picture.height);
  spread_distances(edges, distance, picture.width, picture.height);
  std::vector<std::uint8_t> result(front.size());
  for (std::size_t i = 0; i < front.size(); ++i) {
    const bool known = picture.behind.depth[i] > 0;
    result[i] = known && distance[i] <= (behind[i] - front[i]) / 2 ? 1 : 0;
  }
  return result;
}

}  // namespace relumbre
