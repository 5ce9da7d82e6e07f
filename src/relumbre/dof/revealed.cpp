#include "relumbre/dof/revealed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace relumbre {

namespace {

/// From a pixel's centre to the nearest that may be seen past its edge.
constexpr float kFirst = 1.0F;

/// The nearest silhouette of a pixel's own surface, and the circle of confusion of what is seen
/// past it.
struct Silhouette {
  float distance = std::numeric_limits<float>::infinity();
  float beyond = 0;
};
using Silhouettes = std::vector<Silhouette>;

/// Those of the pixels on the nearer side of a jump.
Silhouettes find_silhouettes(std::span<const float> front, const SurfaceEdges& edges,
                             std::size_t width, std::size_t height) {
  Silhouettes result(front.size());
  const auto compare = [&](std::size_t a, std::size_t b) {
    const auto [near, far] = front[a] < front[b] ? std::pair(a, b) : std::pair(b, a);
    result[near] = {kFirst, std::max(result[near].beyond, front[far])};
  };
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      if (edges.jump(x, y, 1, 0)) compare(i, i + 1);
      if (edges.jump(x, y, 0, 1)) compare(i, i + width);
    }
  }
  return result;
}

/// Tells all pixels of a surface of its silhouettes, by two sweeps over neighbours; distances are
/// right within a tenth (Borgefors 1986).
void spread_silhouettes(const SurfaceEdges& edges, Silhouettes& silhouettes, std::size_t width,
                        std::size_t height) {
  constexpr float kSide = 1, kDiagonal = 1.3507F;
  const auto w = static_cast<std::ptrdiff_t>(width), h = static_cast<std::ptrdiff_t>(height);
  const auto sweep = [&](std::ptrdiff_t x, std::ptrdiff_t y, int step) {
    const auto from = [&](int dx, int dy, float cost) {
      const std::ptrdiff_t u = x + dx, v = y + dy;
      if (u < 0 || u >= w || v < 0 || v >= h) return;
      if (edges.jump(static_cast<std::size_t>(x), static_cast<std::size_t>(y), dx, dy)) return;
      const Silhouette& there = silhouettes[static_cast<std::size_t>(v * w + u)];
      Silhouette& here = silhouettes[static_cast<std::size_t>(y * w + x)];
      if (there.distance + cost < here.distance) here = {there.distance + cost, there.beyond};
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

std::vector<std::uint8_t> revealed(const DepthPicture& picture, const SurfaceEdges& edges,
                                   std::span<const float> front, std::span<const float> behind) {
  Silhouettes silhouettes = find_silhouettes(front, edges, picture.width, picture.height);
  spread_silhouettes(edges, silhouettes, picture.width, picture.height);
  std::vector<std::uint8_t> result(front.size());
  for (std::size_t i = 0; i < front.size(); ++i) {
    const bool known = picture.behind.depth[i] > 0;
    const bool in_reach = silhouettes[i].distance <= (behind[i] - front[i]) / 2;
    const bool in_sight = behind[i] <= silhouettes[i].beyond + kOneSurface;
    result[i] = known && in_reach && in_sight ? 1 : 0;
  }
  return result;
}

}  // namespace relumbre
