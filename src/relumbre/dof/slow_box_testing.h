/// The slow and obvious box filter that tests compare with.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "relumbre/dof/depth_picture.h"

namespace relumbre::test {

/// Each pixel's mean over the square of side 2r + 1 around its centre, pixels at the rim counted by
/// the part of them that lies inside. The picture goes on beyond its border as it ends there.
inline std::vector<Rgba> slow_box(std::span<const Rgba> colors, std::size_t width,
                                  std::size_t height, std::span<const float> radii) {
  // The part of pixel `i` that lies within `r` of the centre of pixel `c`.
  const auto inside = [](int i, int c, double r) {
    return std::max(std::min(i + 0.5, c + 0.5 + r) - std::max(i - 0.5, c - 0.5 - r), 0.0);
  };
  const int w = static_cast<int>(width), h = static_cast<int>(height);
  std::vector<Rgba> result;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const auto r = static_cast<double>(radii[static_cast<std::size_t>(y * w + x)]);
      const int reach = static_cast<int>(std::ceil(r));
      double red = 0, green = 0, blue = 0, alpha = 0, whole = 0;
      for (int v = y - reach; v <= y + reach; ++v) {
        for (int u = x - reach; u <= x + reach; ++u) {
          const double weight = inside(u, x, r) * inside(v, y, r);
          const int at = std::clamp(v, 0, h - 1) * w + std::clamp(u, 0, w - 1);
          const Rgba& c = colors[static_cast<std::size_t>(at)];
          red += weight * static_cast<double>(c.r), green += weight * static_cast<double>(c.g);
          blue += weight * static_cast<double>(c.b), alpha += weight * static_cast<double>(c.a);
          whole += weight;
        }
      }
      const auto mean = [whole](double sum) { return static_cast<float>(sum / whole); };
      result.push_back({mean(red), mean(green), mean(blue), mean(alpha)});
    }
  }
  return result;
}

}  // namespace relumbre::test
