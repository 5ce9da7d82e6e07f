/// Pictures for the tests of the GPU side, which must not need much.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "relumbre/base/sampling.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre::test {

struct Made {
  std::size_t width, height;
  bool alpha = false, behind = false;
};

/// Noise on a floor, before which a tilted disc stands with smooth edges; something bright, and
/// nothing at all in a corner.
inline DepthPicture made_picture(const Made& made) {
  DepthPicture picture{.width = made.width, .height = made.height, .front = {}};
  RandomStream random(5);
  const auto noise = [&](float alpha) {
    return Rgba{alpha * random.uniform(), alpha * random.uniform(), alpha * random.uniform(),
                alpha};
  };
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const auto x = (static_cast<float>(i % made.width) + 0.5F) / static_cast<float>(made.width);
    const auto y = (static_cast<float>(i / made.width) + 0.5F) / static_cast<float>(made.height);
    const bool disc = std::hypot(x - 0.45F, y - 0.4F) < 0.27F;
    const float alpha = made.alpha && random.uniform() < 0.3F ? 0.25F : 1;
    Rgba color = noise(alpha);
    if (random.uniform() < 0.01F) color.g *= 40;
    picture.front.color.push_back(color);
    float depth = disc ? 1.3F + 0.4F * x : 5 - 3 * y;
    if (!disc && x > 0.9F && y < 0.2F) depth = std::numeric_limits<float>::infinity();
    picture.front.depth.push_back(depth);
    if (!made.behind) continue;
    picture.behind.color.push_back(noise(1));
    picture.behind.depth.push_back(random.uniform() < 0.1F ? 0 : 5 - 3 * y);
  }
  return picture;
}

/// In focus at 2 m; of so many pixels of blur at infinity.
inline ThinLens lens_for(double pixels, std::size_t width) {
  ThinLens lens{.focal_length_mm = 50, .f_number = 1, .focus_distance_m = 2, .sensor_width_mm = 36};
  lens.f_number = lens.coc_at_infinity_pixels(width) / pixels;
  return lens;
}

/// Over all channels, of what is larger than 1 relative to it.
inline double worst_difference(const std::vector<Rgba>& a, const std::vector<Rgba>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  const auto take = [&](float x, float y) {
    const double difference = std::abs(static_cast<double>(x) - static_cast<double>(y));
    worst = std::max(worst, difference / std::max(1.0, std::abs(static_cast<double>(y))));
    if (std::isnan(difference)) worst = std::numeric_limits<double>::infinity();
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    take(a[i].r, b[i].r), take(a[i].g, b[i].g), take(a[i].b, b[i].b), take(a[i].a, b[i].a);
  }
  return worst;
}

}  // namespace relumbre::test
