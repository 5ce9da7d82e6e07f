/// Pictures with depth made for tests, and lenses to look at them through.
#pragma once

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre::test {

inline constexpr Rgba kRed{1, 0, 0, 1}, kBlue{0, 0, 1, 1};

/// In focus at 2 m; so many pixels of blur at `depth`.
inline ThinLens blurring(double pixels, std::size_t width, double depth) {
  ThinLens lens{.focal_length_mm = 50, .f_number = 1, .focus_distance_m = 2, .sensor_width_mm = 36};
  lens.f_number = lens.coc_diameter_pixels(depth, width) / pixels;
  return lens;
}

inline void expect_near(const std::vector<Rgba>& a, const std::vector<Rgba>& b, float tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i].r, b[i].r, tolerance) << i;
    ASSERT_NEAR(a[i].g, b[i].g, tolerance) << i;
    ASSERT_NEAR(a[i].b, b[i].b, tolerance) << i;
    ASSERT_NEAR(a[i].a, b[i].a, tolerance) << i;
  }
}

/// One colour at one depth.
inline DepthPicture plane(std::size_t width, std::size_t height, float depth,
                          Rgba color = {0.5F, 0.25F, 1, 1}) {
  DepthPicture picture{.width = width, .height = height, .front = {}};
  picture.front.color.assign(width * height, color);
  picture.front.depth.assign(width * height, depth);
  return picture;
}

/// Every pixel has its own colour.
inline DepthPicture noise(std::size_t width, std::size_t height, float depth) {
  DepthPicture picture = plane(width, height, depth);
  RandomStream random(7);
  for (Rgba& c : picture.front.color) c = {random.uniform(), random.uniform(), random.uniform(), 1};
  return picture;
}

/// Depths between two, at random.
inline void scatter_depths(DepthPicture& picture, float nearest, float farthest) {
  RandomStream random(11);
  for (float& z : picture.front.depth) z = nearest + (farthest - nearest) * random.uniform();
}

/// A rectangle [x0, x1) × [y0, y1) at another depth, of another colour.
inline void add_rectangle(DepthPicture& picture, std::size_t x0, std::size_t x1, std::size_t y0,
                          std::size_t y1, float depth, Rgba color) {
  for (std::size_t y = y0; y < y1; ++y) {
    for (std::size_t x = x0; x < x1; ++x) {
      picture.front.color[y * picture.width + x] = color;
      picture.front.depth[y * picture.width + x] = depth;
    }
  }
}

}  // namespace relumbre::test
