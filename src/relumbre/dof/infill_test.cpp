#include "relumbre/dof/infill.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "relumbre/dof/focus.h"
#include "relumbre/dof/surface_edges.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::add_rectangle, test::noise, test::plane, test::scatter_depths;

constexpr Rgba kRed{1, 0, 0, 1}, kBlue{0, 0.25F, 1, 1};
constexpr float kInf = std::numeric_limits<float>::infinity();

/// 20 pixels of blur at half the distance in focus.
ThinLens lens_for(std::size_t width) {
  ThinLens lens{.focal_length_mm = 50, .f_number = 1, .focus_distance_m = 2, .sensor_width_mm = 36};
  lens.f_number = lens.coc_diameter_pixels(1, width) / 20;
  return lens;
}

std::vector<float> circles_of(const DepthPicture& picture) {
  return circles_of_confusion(picture.front.depth, lens_for(picture.width), picture.width, 512);
}

PictureLayer filled(const DepthPicture& picture) {
  return fill_behind(picture, circles_of(picture));
}

TEST(Infill, BehindAForegroundIsTheBackground) {
  DepthPicture picture = plane(120, 90, 2, kBlue);
  add_rectangle(picture, 30, 90, 20, 70, 1, kRed);
  const PictureLayer layer = filled(picture);
  for (std::size_t y = 0; y < 90; ++y) {
    for (std::size_t x = 0; x < 120; ++x) {
      const std::size_t i = y * 120 + x;
      if (x < 30 || x >= 90 || y < 20 || y >= 70) {
        EXPECT_EQ(layer.color[i].a, 0) << x << "," << y;
        continue;
      }
      const std::size_t from_edge = std::min(std::min(x - 30, 89 - x), std::min(y - 20, 69 - y));
      if (from_edge < 4) {
        EXPECT_NEAR(layer.color[i].a, 1, 1e-4F) << x << "," << y;
      }
      if (layer.color[i].a == 0) continue;
      EXPECT_NEAR(layer.color[i].r, 0, 1e-4F);
      EXPECT_NEAR(layer.color[i].g, 0.25, 1e-4F);
      EXPECT_NEAR(layer.color[i].b, 1, 1e-4F);
      EXPECT_NEAR(layer.depth[i], 2, 1e-3F);
    }
  }
}

TEST(Infill, FartherInThanBlursReachNothingIsGuessed) {
  DepthPicture picture = plane(200, 200, 2, kBlue);
  add_rectangle(picture, 20, 180, 20, 180, 1, kRed);
  const PictureLayer layer = filled(picture);
  for (std::size_t y = 80; y < 120; ++y)
    for (std::size_t x = 80; x < 120; ++x) EXPECT_EQ(layer.color[y * 200 + x].a, 0);
}

TEST(Infill, NothingLiesBehindWhatIsFarthest) {
  DepthPicture picture = noise(67, 43, 2);
  scatter_depths(picture, 1, 4);
  const std::vector<float> circles = circles_of(picture);
  const float far = *std::ranges::max_element(circles);
  const PictureLayer layer = fill_behind(picture, circles);
  for (std::size_t i = 0; i < circles.size(); ++i) {
    if (circles[i] >= far - kOneSurface) {
      EXPECT_EQ(layer.color[i].a, 0);
    }
  }
  for (const Rgba& c : filled(plane(50, 40, 1)).color) EXPECT_EQ(c.a, 0);
}

TEST(Infill, WhatIsFilledInLiesFartherAway) {
  DepthPicture picture = noise(67, 43, 2);
  scatter_depths(picture, 1, 4);
  const std::vector<float> circles = circles_of(picture);
  const PictureLayer layer = fill_behind(picture, circles);
  const std::vector<float> behind =
      circles_of_confusion(layer.depth, lens_for(67), picture.width, 512);
  std::size_t found = 0;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    if (layer.color[i].a == 0) continue;
    ++found;
    EXPECT_GT(behind[i], circles[i] + 0.99F * kOneSurface);
    EXPECT_GT(layer.depth[i], picture.front.depth[i]);
  }
  EXPECT_GT(found, picture.pixels() / 4);
}

TEST(Infill, OfTwoBackgroundsTheFartherIsTaken) {
  // To the left of the foreground a wall at 2 m, to its right one at 8 m.
  DepthPicture picture = plane(90, 40, 2, kBlue);
  add_rectangle(picture, 45, 90, 0, 40, 8, {0, 1, 0, 1});
  add_rectangle(picture, 40, 50, 0, 40, 1, kRed);
  const PictureLayer layer = filled(picture);
  const std::size_t right = 20 * 90 + 48;
  EXPECT_NEAR(layer.color[right].g, 1, 1e-2F);
  EXPECT_NEAR(layer.depth[right], 8, 0.1F);
}

TEST(Infill, TransparentBackgroundsStayTransparent) {
  DepthPicture picture = plane(80, 60, kInf, {0.1F, 0, 0.2F, 0.5F});
  add_rectangle(picture, 30, 50, 20, 40, 1, kRed);
  const PictureLayer layer = filled(picture);
  const Rgba& c = layer.color[30 * 80 + 32];
  EXPECT_NEAR(c.r, 0.1, 1e-4F);
  EXPECT_NEAR(c.b, 0.2, 1e-4F);
  EXPECT_NEAR(c.a, 0.5, 1e-4F);
  EXPECT_EQ(layer.depth[30 * 80 + 32], kInf);

  picture = plane(80, 60, kInf, {});
  add_rectangle(picture, 30, 50, 20, 40, 1, kRed);
  for (const Rgba& filled_in : filled(picture).color) EXPECT_EQ(filled_in, Rgba{});
}

TEST(Infill, MixedPixelsHardlyColourWhatIsFilledIn) {
  DepthPicture picture = plane(80, 60, 2, kBlue);
  add_rectangle(picture, 30, 50, 0, 60, 1, kRed);
  // The smooth edge has the background's depth and half of the foreground's colour.
  add_rectangle(picture, 50, 51, 0, 60, 2, {0.5F, 0.125F, 0.5F, 1});
  const Rgba c = filled(picture).color[30 * 80 + 48];
  EXPECT_NEAR(c.r, 0, 0.02F);
  EXPECT_NEAR(c.b, 1, 0.02F);
}

TEST(Infill, NothingGlowsBesideAnEdge) {
  // Wherever the edge lies in the pyramid's squares, some of which have nothing but mixed pixels.
  for (std::size_t edge = 50; edge < 58; ++edge) {
    DepthPicture picture = plane(90, 60, 2, kBlue);
    add_rectangle(picture, 30, edge, 0, 60, 1, kRed);
    add_rectangle(picture, edge, edge + 1, 0, 60, 2, {0.5F, 0.125F, 0.5F, 1});
    const PictureLayer layer = filled(picture);
    for (std::size_t x = 42; x < edge; ++x) {
      const Rgba c = layer.color[30 * 90 + x];
      if (c.a > 0) {
        ASSERT_NEAR(c.r, 0, 0.02F) << edge << ": " << x;
      }
    }
  }
}

TEST(Infill, AwkwardSizesWork) {
  for (const auto& [width, height] :
       {std::pair{1U, 1U}, {2U, 1U}, {1U, 33U}, {33U, 1U}, {3U, 3U}}) {
    DepthPicture picture = plane(width, height, 2, kBlue);
    picture.front.depth[0] = 1;
    const PictureLayer layer = filled(picture);
    ASSERT_EQ(layer.color.size(), picture.pixels());
    ASSERT_EQ(layer.depth.size(), picture.pixels());
    if (picture.pixels() > 1) {
      EXPECT_NEAR(layer.color[0].b, 1, 1e-4F);
    }
    for (std::size_t i = 1; i < layer.color.size(); ++i) EXPECT_EQ(layer.color[i].a, 0);
  }
}

}  // namespace
}  // namespace relumbre
