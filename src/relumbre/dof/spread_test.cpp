#include "relumbre/dof/spread.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::add_rectangle, test::noise, test::plane, test::scatter_depths;

const ThinLens kLens{
    .focal_length_mm = 50, .f_number = 1.4, .focus_distance_m = 2, .sensor_width_mm = 36};
constexpr Rgba kRed{1, 0, 0, 1}, kBlue{0, 0, 1, 1}, kBlack{0, 0, 0, 1};

std::vector<SpreadConfig> all_shapes() {
  std::vector<SpreadConfig> shapes(5);
  shapes[1].shape = BlurShape::kBox;
  shapes[2].aperture.blades = 6;
  shapes[3].aperture = {.blades = 8, .rotation_deg = 22.5};
  shapes[4].aperture = {.blades = 5, .rotation_deg = 13};
  return shapes;
}

double red(const std::vector<Rgba>& picture) {
  double sum = 0;
  for (const Rgba& c : picture) sum += static_cast<double>(c.r);
  return sum;
}

/// One bright pixel in the middle of a black plane.
DepthPicture point_light(std::size_t size, float depth, float power) {
  DepthPicture picture = plane(size, size, depth, kBlack);
  picture.front.color[size / 2 * size + size / 2].r = power;
  return picture;
}

/// A lens that blurs what is at 4 m (or at 1 m, before the plane in focus) by so many pixels.
ThinLens blurring(double pixels, std::size_t width, double depth) {
  ThinLens lens = kLens;
  lens.f_number *= lens.coc_diameter_pixels(depth, width) / pixels;
  return lens;
}

TEST(Spread, ConstantPictureStaysConstant) {
  DepthPicture picture = plane(83, 61, 2);
  scatter_depths(picture, 1, 9);
  for (const SpreadConfig& config : all_shapes()) {
    for (const Rgba& c : spread(picture, kLens, config)) {
      ASSERT_NEAR(c.r, 0.5F, 1e-5F);
      ASSERT_NEAR(c.g, 0.25F, 1e-5F);
      ASSERT_NEAR(c.b, 1, 1e-5F);
      ASSERT_NEAR(c.a, 1, 1e-5F);
    }
  }
}

TEST(Spread, WhatIsInFocusIsUntouched) {
  const DepthPicture picture = noise(83, 61, 2);
  for (const SpreadConfig& config : all_shapes()) {
    const std::vector<Rgba> result = spread(picture, kLens, config);
    for (std::size_t i = 0; i < result.size(); ++i) {
      ASSERT_NEAR(result[i].r, picture.front.color[i].r, 1e-5F);
      ASSERT_NEAR(result[i].b, picture.front.color[i].b, 1e-5F);
    }
  }
}

TEST(Spread, PointLightBecomesADiscOfTheFormulasRadius) {
  for (const double diameter : {6.0, 11.3, 24.0, 51.7}) {
    for (const float depth : {1.0F, 4.0F}) {
      constexpr std::size_t kSize = 101;
      const ThinLens lens = blurring(diameter, kSize, static_cast<double>(depth));
      const std::vector<Rgba> result = spread(point_light(kSize, depth, 1000), lens);
      const double level = 1000 / (std::numbers::pi / 4 * diameter * diameter);
      for (std::size_t i = 0; i < result.size(); ++i) {
        const double x = static_cast<double>(i % kSize) - 50,
                     y = static_cast<double>(i / kSize) - 50;
        const double r = std::hypot(x, y), from_rim = r - diameter / 2;
        if (std::abs(from_rim) <= 1) continue;
        ASSERT_NEAR(result[i].r, from_rim < 0 ? level : 0, 0.02 * level) << x << "," << y;
      }
    }
  }
}

TEST(Spread, EnergyIsKeptAwayFromBorders) {
  for (const SpreadConfig& config : all_shapes()) {
    for (const double diameter : {0.5, 1.0, 1.5, 2.3, 7.9, 31.0, 60.0}) {
      const DepthPicture picture = point_light(101, 4, 1000);
      EXPECT_NEAR(red(spread(picture, blurring(diameter, 101, 4), config)), 1000, 0.05);
    }
  }
}

TEST(Spread, LargeBoxesCrossStripesWithoutASeam) {
  constexpr std::size_t kSize = 401;  // more than two stripes of either height
  constexpr double kDiameter = 150;
  const double side = std::sqrt(std::numbers::pi) / 2 * kDiameter;
  const auto result = spread(point_light(kSize, 4, 1e4F), blurring(kDiameter, kSize, 4),
                             {.shape = BlurShape::kBox});
  EXPECT_NEAR(red(result), 1e4, 0.5);
  for (std::size_t y = 200 - 65; y <= 200 + 65; ++y)
    ASSERT_NEAR(result[y * kSize + 180].r, 1e4 / (side * side), 1e-4) << y;
}

TEST(Spread, BlursBeforeTheFocusAreTurnedByHalfATurn) {
  SpreadConfig triangle;
  triangle.aperture = {.blades = 3, .rotation_deg = 10};
  constexpr std::size_t kSize = 61;
  const auto behind = spread(point_light(kSize, 4, 1), blurring(20, kSize, 4), triangle);
  const auto before = spread(point_light(kSize, 1, 1), blurring(20, kSize, 1), triangle);
  double largest = 0;
  for (std::size_t i = 0; i < behind.size(); ++i) {
    EXPECT_NEAR(behind[i].r, before[before.size() - 1 - i].r, 1e-5F);
    largest = std::max(largest, std::abs(static_cast<double>(behind[i].r - before[i].r)));
  }
  EXPECT_GT(largest, 1e-3);
}

TEST(Spread, DoesNotDependOnTheNumberOfThreads) {
  DepthPicture picture = noise(130, 210, 2);
  scatter_depths(picture, 0.8F, 30);
  for (const SpreadConfig& config : all_shapes()) {
    const auto whole = spread(picture, kLens, config);
    const ThreadLimit one(1);
    EXPECT_EQ(spread(picture, kLens, config), whole);
  }
}

TEST(Spread, SharpForegroundDoesNotBleedIntoABlurredBackground) {
  DepthPicture picture = plane(120, 80, 40, kBlue);
  add_rectangle(picture, 40, 80, 0, 80, 2, kRed);
  for (const SpreadConfig& config : all_shapes()) {
    const auto result = spread(picture, kLens, config);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const std::size_t x = i % 120;
      const bool foreground = x >= 40 && x < 80;
      ASSERT_NEAR(result[i].r, foreground ? 1 : 0, 1e-4F) << x;
      ASSERT_NEAR(result[i].b, foreground ? 0 : 1, 1e-4F) << x;
    }
  }
}

TEST(Spread, BlurredForegroundHasASoftSilhouetteOnBothSides) {
  constexpr std::size_t kWidth = 161, kHeight = 40, kEdge = 80;
  DepthPicture picture = plane(kWidth, kHeight, 2, kBlue);
  add_rectangle(picture, 0, kEdge, 0, kHeight, 1, kRed);
  picture.behind = plane(kWidth, kHeight, 2, kBlue).front;
  const double diameter = 30;
  const auto result = spread(picture, blurring(diameter, kWidth, 1));
  const Rgba* row = &result[kHeight / 2 * kWidth];
  EXPECT_NEAR(row[kEdge - 17].r, 1, 0.01);
  EXPECT_NEAR(row[kEdge + 16].r, 0, 0.01);
  for (int d = -14; d <= 14; ++d) {
    // The share of a disc on one side of a line at distance t from its centre.
    const double t = std::clamp((d + 0.5) / (diameter / 2), -1.0, 1.0);
    const double share = (std::acos(t) - t * std::sqrt(1 - t * t)) / std::numbers::pi;
    EXPECT_NEAR(row[static_cast<int>(kEdge) + d].r, share, 0.03) << d;
    EXPECT_NEAR(row[static_cast<int>(kEdge) + d].b, 1 - share, 0.03) << d;
  }
}

TEST(Spread, NoSeamAtThePlaneInFocusOnASlantedFloor) {
  constexpr std::size_t kWidth = 64, kHeight = 200;
  DepthPicture picture = plane(kWidth, kHeight, 2);
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    picture.front.depth[i] = 1 + 0.01F * static_cast<float>(i / kWidth);
  // A fine grid in red alone: its mean must not change anywhere.
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    picture.front.color[i].r = 0.5F + 0.001F * static_cast<float>(i / kWidth);
  const auto result = spread(picture, kLens);
  for (std::size_t y = 20; y + 20 < kHeight; ++y)
    EXPECT_NEAR(result[y * kWidth + 32].r, 0.5 + 0.001 * static_cast<double>(y), 0.004) << y;
}

TEST(Spread, BlurIsTheSameFractionOfThePictureAtEveryResolution) {
  const auto width_at_half = [](std::size_t size) {
    const auto result = spread(point_light(size, 4, 1e4F), kLens);
    const Rgba* row = &result[size / 2 * size];
    const float top = row[size / 2].r;
    std::size_t wide = 0;
    for (std::size_t x = 0; x < size; ++x) wide += row[x].r > top / 2 ? 1 : 0;
    return static_cast<double>(wide) / static_cast<double>(size);
  };
  EXPECT_NEAR(width_at_half(201), width_at_half(401), 0.01);
}

TEST(Spread, BordersAreNotDarkened) {
  for (const SpreadConfig& config : all_shapes()) {
    DepthPicture picture = plane(60, 50, 1, kRed);
    picture.behind = plane(60, 50, 9, kBlue).front;
    for (const Rgba& c : spread(picture, kLens, config)) ASSERT_NEAR(c.r, 1, 1e-4F);
  }
}

TEST(Spread, TransparentPicturesStayTransparent) {
  DepthPicture picture = plane(60, 50, 4, {});
  add_rectangle(picture, 20, 40, 15, 35, 4, {0.5F, 0, 0, 0.5F});
  const auto result = spread(picture, kLens);
  for (const Rgba& c : result) ASSERT_NEAR(c.r, c.a, 1e-5F);
  EXPECT_NEAR(result[25 * 60 + 30].a, 0.5, 0.02);
  EXPECT_NEAR(result[0].a, 0, 1e-5);
}

TEST(Spread, AwkwardSizesWork) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 300}, {300, 1}, {49, 48}, {2, 97}}) {
    DepthPicture picture =
        plane(static_cast<std::size_t>(width), static_cast<std::size_t>(height), 9);
    for (const SpreadConfig& config : all_shapes())
      for (const Rgba& c : spread(picture, kLens, config)) ASSERT_NEAR(c.b, 1, 1e-5F);
  }
}

TEST(Spread, HighlightsLeaveNoTraceBesideTheirBlur) {
  const auto result = spread(point_light(201, 4, 1e9F), blurring(8, 201, 4));
  EXPECT_NEAR(result[100 * 201 + 150].r, 0, 1e-4);
  EXPECT_NEAR(result[150 * 201 + 100].r, 0, 1e-4);
}

TEST(Spread, RefusesBadDepthAndLenses) {
  DepthPicture picture = plane(8, 8, 2);
  picture.front.depth[5] = -1;
  EXPECT_THROW(spread(picture, kLens), ValueError);
  picture = plane(8, 8, 2);
  ThinLens lens = kLens;
  lens.f_number = 0;
  EXPECT_THROW(spread(picture, lens), ValueError);
  EXPECT_THROW(spread(DepthPicture{}, kLens), ShapeError);
}

}  // namespace
}  // namespace relumbre
