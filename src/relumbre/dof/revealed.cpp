#include "relumbre/dof/revealed.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relumbre {

namespace {

/// Neighbours whose circles of confusion differ by more are of two surfaces, pixels.
constexpr float kOneSurface = 1.5F;
/// From a pixel's centre to its side.
constexpr float kHalfPixel = 1.0F;

/// Half a pixel on the nearer side of every silhouette, infinity elsewhere.
std::vector<float> silhouettes(std::span<const float> front, std::size_t width,
                               std::size_t height) {
  std::vector<float> distance(front.size(), std::numeric_limits<float>::infinity());
  const auto compare = [&](std::size_t a, std::size_t b) {
    if (std::abs(front[a] - front[b]) > kOneSurface)
      distance[front[a] < front[b] ? a : b] = kHalfPixel;
  };
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      if (x + 1 < width) compare(i, i + 1);
      if (y + 1 < height) compare(i, i + width);
    }
  }
  return distance;
}

/// Distances to the nearest silhouette by two sweeps over neighbours, within a tenth (Borgefors
/// 1986).
void spread_distances(std::vector<float>& distance, std::size_t width, std::size_t height) {
  constexpr float kSide = 1, kDiagonal = 1.3507F;
  const auto w = static_cast<std::ptrdiff_t>(width), h = static_cast<std::ptrdiff_t>(height);
  const auto sweep = [&](std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t step) {
    float& here = distance[static_cast<std::size_t>(y * w + x)];
    const auto from = [&](std::ptrdiff_t u, std::ptrdiff_t v, float cost) {
      if (u < 0 || u >= w || v < 0 || v >= h) return;
      here = std::min(here, distance[static_cast<std::size_t>(v * w + u)] + cost);
    };
    from(x - step, y, kSide), from(x, y - step, kSide);
    from(x - 1, y - step, kDiagonal), from(x + 1, y - step, kDiagonal);
  };
  for (std::ptrdiff_t y = 0; y < h; ++y)
    for (std::ptrdiff_t x = 0; x < w; ++x) sweep(x, y, 1);
  for (std::ptrdiff_t y = h - 1; y >= 0; --y)
    for (std::ptrdiff_t x = w - 1; x >= 0; --x) sweep(x, y, -1);
}

}  // namespace

std::vector<std::uint8_t> revealed(const DepthPicture& picture, std::span<const float> front,
                                   std::span<const float> behind) {
  std::vector<float> distance = silhouettes(front, picture.width, picture.height);
  spread_distances(distance, picture.width, picture.height);
  std::vector<std::uint8_t> result(front.size());
  for (std::size_t i = 0; i < front.size(); ++i) {
    const bool known = picture.behind.depth[i] > 0;
    result[i] = known && distance[i] <= (behind[i] - front[i]) / 2 ? 1 : 0;
  }
  return result;
}

}  // namespace relumbre
