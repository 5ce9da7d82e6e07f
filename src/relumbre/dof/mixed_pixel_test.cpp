#include "relumbre/dof/mixed_pixel.h"

#include <cmath>

#include <gtest/gtest.h>

#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::noise, test::plane;

constexpr Rgba kRed{1, 0.1F, 0, 1}, kBlue{0, 0.2F, 2, 1};
constexpr float kNear = -20, kFar = 6;

Rgba mixture(float share, const Rgba& a, const Rgba& b) {
  const auto mix = [share](float x, float y) { return share * x + (1 - share) * y; };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), mix(a.a, b.a)};
}

void expect_near(const Rgba& a, const Rgba& b, float tolerance) {
  ASSERT_NEAR(a.r, b.r, tolerance);
  ASSERT_NEAR(a.g, b.g, tolerance);
  ASSERT_NEAR(a.b, b.b, tolerance);
  ASSERT_NEAR(a.a, b.a, tolerance);
}

/// Near to the left of column `kEdge`, far to the right, a mixture in that column, whose depth is
/// the one or the other.
struct SmoothEdge {
  static constexpr std::size_t kWidth = 20, kHeight = 9, kEdge = 10;
  DepthPicture picture = plane(kWidth, kHeight, 1);
  std::vector<float> circles = std::vector<float>(kWidth * kHeight);

  SmoothEdge(float share, bool depth_is_near, const Rgba& near = kRed, const Rgba& far = kBlue) {
    for (std::size_t i = 0; i < circles.size(); ++i) {
      const std::size_t x = i % kWidth;
      const bool is_near = x < kEdge || (x == kEdge && depth_is_near);
      circles[i] = is_near ? kNear : kFar;
      picture.front.color[i] = x == kEdge ? mixture(share, near, far) : is_near ? near : far;
    }
  }
};

Unmixer unmixer(const DepthPicture& picture, std::span<const float> circles) {
  return {picture, circles, SurfaceEdges(circles, picture.width, picture.height)};
}

/// Columns [10, 10 + wide) are a lamp between the near and the far surface.
SmoothEdge with_lamp(std::size_t wide, float circle, const Rgba& color) {
  SmoothEdge edge(0, false);
  for (std::size_t i = 0; i < edge.circles.size(); ++i) {
    const std::size_t x = i % SmoothEdge::kWidth;
    if (x < SmoothEdge::kEdge || x >= SmoothEdge::kEdge + wide) continue;
    edge.circles[i] = circle, edge.picture.front.color[i] = color;
  }
  return edge;
}

TEST(MixedPixel, SurfacesTwoPixelsAwayAreNotOneOfTheTwo) {
  constexpr float kLamp = -8;
  const SmoothEdge edge = with_lamp(2, kLamp, {90, 80, 70, 1});
  const Unmixer unmix = unmixer(edge.picture, edge.circles);
  const auto mixed = unmix(SmoothEdge::kEdge, 4);
  ASSERT_TRUE(mixed.has_value());
  EXPECT_NEAR(mixed->near_coc, kNear, 1e-4F);
  EXPECT_NEAR(mixed->far_coc, kLamp, 1e-4F);
  EXPECT_NEAR(mixed->share, 0, 1e-4F);
  expect_near(mixed->far, {90, 80, 70, 1}, 1e-3F);
}

TEST(MixedPixel, LightThatNeitherSurfaceHasIsNotBlurredWithTheSofterOne) {
  const Rgba lamp{40, 8, 20, 1};  // as far from the one colour as from the other
  const SmoothEdge edge = with_lamp(1, kFar, lamp);
  const Unmixer unmix = unmixer(edge.picture, edge.circles);
  const auto mixed = unmix(SmoothEdge::kEdge, 4);
  ASSERT_TRUE(mixed.has_value());
  EXPECT_EQ(mixed->share, 0);  // the far one is the sharper
  EXPECT_NEAR(mixed->far_coc, kFar, 1e-4F);
  expect_near(mixed->far, lamp, 1e-4F);
}

TEST(MixedPixel, TheShareOfASmoothEdgeIsFound) {
  for (const float share : {0.0F, 0.1F, 0.3F, 0.5F, 0.8F, 1.0F}) {
    for (const bool depth_is_near : {true, false}) {
      const SmoothEdge edge(share, depth_is_near);
      const Unmixer unmix = unmixer(edge.picture, edge.circles);
      for (std::size_t y = 0; y < SmoothEdge::kHeight; ++y) {
        const auto mixed = unmix(SmoothEdge::kEdge, y);
        ASSERT_TRUE(mixed.has_value());
        EXPECT_NEAR(mixed->share, share, 2e-3F);
        EXPECT_NEAR(mixed->near_coc, kNear, 1e-4F);
        EXPECT_NEAR(mixed->far_coc, kFar, 1e-4F);
        expect_near(mixed->near, kRed, 5e-3F);
        expect_near(mixed->far, kBlue, 5e-3F);
      }
    }
  }
}

TEST(MixedPixel, UnmixedPixelsBesideAnEdgeStayWhole) {
  const SmoothEdge edge(0.4F, true);
  const Unmixer unmix = unmixer(edge.picture, edge.circles);
  const auto beside = unmix(SmoothEdge::kEdge + 1, 4);
  ASSERT_TRUE(beside.has_value());
  EXPECT_NEAR(beside->share, 0, 2e-3F);
}

TEST(MixedPixel, AwayFromEdgesNothingIsMixed) {
  const SmoothEdge edge(0.4F, true);
  const Unmixer unmix = unmixer(edge.picture, edge.circles);
  for (std::size_t y = 0; y < SmoothEdge::kHeight; ++y) {
    for (std::size_t x = 0; x < SmoothEdge::kWidth; ++x) {
      const bool at_jump = x == SmoothEdge::kEdge || x == SmoothEdge::kEdge + 1;
      EXPECT_EQ(unmix(x, y).has_value(), at_jump) << x << "," << y;
    }
  }
}

TEST(MixedPixel, TheMixtureIsThePixelsColour) {
  DepthPicture picture = noise(41, 31, 2);
  picture.front.color[200] = {900, 3000, 1, 1};  // a lamp
  std::vector<float> circles(picture.pixels());
  RandomStream random(3);
  for (float& circle : circles) circle = 40 * random.uniform() - 20;
  const Unmixer unmix = unmixer(picture, circles);
  std::size_t found = 0;
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const auto mixed = unmix(i % 41, i / 41);
    if (!mixed) continue;
    ++found;
    EXPECT_GE(mixed->share, 0);
    EXPECT_LE(mixed->share, 1);
    EXPECT_LT(mixed->near_coc, mixed->far_coc);
    const Rgba& c = picture.front.color[i];
    // Sums of neighbours are rounded to their own size.
    const float tolerance = 2e-6F + 1e-6F * (std::abs(mixed->near.g) + std::abs(mixed->far.g));
    expect_near(mixture(mixed->share, mixed->near, mixed->far), c, tolerance);
  }
  EXPECT_GT(found, picture.pixels() / 2);
}

TEST(MixedPixel, WhereBothSidesLookAlikeDepthDecides) {
  for (const bool depth_is_near : {true, false}) {
    const SmoothEdge edge(0.5F, depth_is_near, kRed, kRed);
    const auto mixed = unmixer(edge.picture, edge.circles)(SmoothEdge::kEdge, 3);
    ASSERT_TRUE(mixed.has_value());
    EXPECT_EQ(mixed->share, depth_is_near ? 1 : 0);
  }
}

TEST(MixedPixel, ATransparentBackgroundIsASurfaceToo) {
  const SmoothEdge edge(0.25F, true, kRed, {});
  const auto mixed = unmixer(edge.picture, edge.circles)(SmoothEdge::kEdge, 3);
  ASSERT_TRUE(mixed.has_value());
  EXPECT_NEAR(mixed->share, 0.25, 2e-3F);
  expect_near(mixed->far, {}, 2e-3F);
}

TEST(MixedPixel, AwkwardSizesWork) {
  for (const auto& [width, height] : {std::pair{2U, 1U}, {1U, 2U}, {1U, 9U}, {9U, 1U}, {2U, 2U}}) {
    const DepthPicture picture = noise(width, height, 2);
    std::vector<float> circles(picture.pixels(), 9);
    circles[0] = -9;
    const Unmixer unmix = unmixer(picture, circles);
    const auto mixed = unmix(0, 0);
    ASSERT_TRUE(mixed.has_value());
    expect_near(mixture(mixed->share, mixed->near, mixed->far), picture.front.color[0], 1e-5F);
  }
  const DepthPicture one = plane(1, 1, 2);
  const std::vector<float> circle{5};
  EXPECT_FALSE(unmixer(one, circle)(0, 0).has_value());
}

}  // namespace
}  // namespace relumbre
