#include "relumbre/image/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

constexpr double kMaxRadius = 4096;

void check(std::size_t depths, std::size_t width, std::size_t height,
           const SilhouetteConfig& config) {
  if (width == 0 || depths % width != 0 || depths / width != height) {
    throw ShapeError(
        fmt::format("silhouettes: {} depths for {} x {} pixels", depths, width, height));
  }
  if (!(config.relative_jump > 0)) {
    throw ValueError(fmt::format("silhouettes: a relative jump of {}; it must be above 0",
                                 config.relative_jump));
  }
  if (!(config.radius_pixels >= 0 && config.radius_pixels <= kMaxRadius)) {
    throw ValueError(fmt::format("silhouettes: a radius of {} pixels; 0 to {} are possible",
                                 config.radius_pixels, kMaxRadius));
  }
}

/// 1 / depth: 0 where nothing is.
double nearness(float depth) { return depth > 0 ? 1 / static_cast<double>(depth) : 0; }

/// |z − z'| > jump · min(z, z'), divided by both depths.
bool jumps(float a, float b, double jump) {
  const double p = nearness(a), q = nearness(b);
  return std::abs(p - q) > jump * std::min(p, q);
}

std::vector<std::uint8_t> pixels_at_jumps(std::span<const float> depth, std::size_t width,
                                          std::size_t height, double jump) {
  std::vector<std::uint8_t> mask(depth.size());
  parallel_for(0, height, 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      const bool left = x > 0 && jumps(depth[i], depth[i - 1], jump);
      const bool right = x + 1 < width && jumps(depth[i], depth[i + 1], jump);
      const bool above = y > 0 && jumps(depth[i], depth[i - width], jump);
      const bool below = y + 1 < height && jumps(depth[i], depth[i + width], jump);
      mask[i] = left || right || above || below ? 1 : 0;
    }
  });
  return mask;
}

/// Distance within the row to the nearest marked pixel; a large number where there is none.
std::vector<float> row_distances(std::span<const std::uint8_t> mask, std::size_t width,
                                 std::size_t height) {
  std::vector<float> distance(mask.size());
  parallel_for(0, height, 16, [&](std::size_t y) {
    const std::span<float> row(distance.data() + y * width, width);
    float last = std::numeric_limits<float>::max() / 4;
    for (std::size_t x = 0; x < width; ++x) row[x] = last = mask[y * width + x] != 0 ? 0 : last + 1;
    for (std::size_t x = width; x-- > 0;) row[x] = last = std::min(row[x], last + 1);
  });
  return distance;
}

}  // namespace

std::vector<std::uint8_t> silhouette_band(std::span<const float> depth, std::size_t width,
                                          std::size_t height, const SilhouetteConfig& config) {
  check(depth.size(), width, height, config);
  std::vector<std::uint8_t> mask = pixels_at_jumps(depth, width, height, config.relative_jump);
  const std::vector<float> in_row = row_distances(mask, width, height);
  const auto reach = static_cast<std::size_t>(config.radius_pixels);
  parallel_for(0, height, 16, [&](std::size_t y) {
    const std::size_t first = y - std::min(y, reach), last = std::min(height - 1, y + reach);
    for (std::size_t other = first; other <= last; ++other) {
      const double dy = static_cast<double>(other) - static_cast<double>(y);
      const double dx = std::sqrt(config.radius_pixels * config.radius_pixels - dy * dy);
      for (std::size_t x = 0; x < width; ++x) {
        if (static_cast<double>(in_row[other * width + x]) <= dx) mask[y * width + x] = 1;
      }
    }
  });
  return mask;
}

}  // namespace relumbre
