#include "relumbre/dof/layered.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/dof/blur_steps.h"
#include "relumbre/dof/cover.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/fragments.h"
#include "relumbre/dof/slow_box_testing.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::add_rectangle, test::blurring, test::expect_near, test::kBlue, test::kRed, test::noise,
    test::plane, test::scatter_depths, test::slow_box;

/// 1 at step i, falling evenly to 0 at those beside it.
float tent(const std::vector<float>& steps, std::size_t i, float coc) {
  if (coc == steps[i]) return 1;
  if (coc < steps[i])
    return i == 0 ? 0 : std::max(1 - (steps[i] - coc) / (steps[i] - steps[i - 1]), 0.0F);
  return i + 1 == steps.size() ? 0
                               : std::max(1 - (coc - steps[i]) / (steps[i + 1] - steps[i]), 0.0F);
}

/// Every step by itself, from front to back: all fragments, weighted by the step's tent, in a
/// picture of their own.
std::vector<Rgba> slow_layered(const DepthPicture& picture, const ThinLens& lens,
                               const LayeredConfig& config) {
  const auto circles = [&](const PictureLayer& layer) {
    return circles_of_confusion(layer.depth, lens, picture.width, config.largest_diameter);
  };
  const auto fragments = fragments_of(picture, circles(picture.front), circles(picture.behind));
  const auto [least, largest] = std::ranges::minmax(fragments, {}, &Fragment::coc);
  const std::vector<float> steps = blur_steps(least.coc, largest.coc, config.layers);
  Cover cover(picture.pixels());
  for (std::size_t step = 0; step < steps.size(); ++step) {
    std::vector<Rgba> colors(picture.pixels()), coverages(picture.pixels());
    for (const Fragment& f : fragments) {
      const float w = tent(steps, step, f.coc);
      Rgba& c = colors[f.y * picture.width + f.x];
      c = {c.r + w * f.color.r, c.g + w * f.color.g, c.b + w * f.color.b, c.a + w * f.color.a};
      coverages[f.y * picture.width + f.x].a += w * f.coverage;
    }
    const auto circle = static_cast<double>(std::abs(steps[step]));
    const double side = std::sqrt(std::numbers::pi) / 2 * circle;
    const std::vector<float> radii(picture.pixels(),
                                   static_cast<float>(std::max((side - 1) / 2, 0.0)));
    colors = slow_box(colors, picture.width, picture.height, radii);
    coverages = slow_box(coverages, picture.width, picture.height, radii);
    for (std::size_t i = 0; i < colors.size(); ++i)
      cover.add(i, colors[i], static_cast<double>(coverages[i].a), tolerance_of(circle));
  }
  std::vector<Rgba> result;
  for (std::size_t i = 0; i < picture.pixels(); ++i) result.push_back(cover.color(i));
  return result;
}

TEST(Layered, ConstantPictureStaysConstant) {
  for (const float depth : {0.7F, 2.0F, 9.0F, std::numeric_limits<float>::infinity()}) {
    const DepthPicture picture = plane(83, 61, depth);
    expect_near(layered(picture, blurring(20, 83, 1)), picture.front.color, 1e-6F);
  }
}

TEST(Layered, ASurfaceThatCrossesLayersHidesWhatLiesBehind) {
  DepthPicture picture = plane(90, 60, 2, kBlue);
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    picture.front.depth[i] = 1.2F + 0.03F * static_cast<float>(i % 90);
  picture.behind = plane(90, 60, 40, {1000, 0, 0, 1}).front;
  for (const Rgba& c : layered(picture, blurring(12, 90, 1.2))) {
    ASSERT_NEAR(c.r, 0, 1e-3F);
    ASSERT_NEAR(c.b, 1, 1e-5F);
  }
}

TEST(Layered, ASteepSurfaceHasNoLinesWhereStepsMeet) {
  // The circle of confusion grows by a pixel a column, through the plane in focus.
  constexpr std::size_t kWidth = 120;
  const ThinLens lens = blurring(40, kWidth, 1);
  DepthPicture picture = plane(kWidth, 60, 40, kBlue);
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const double column = static_cast<double>(i % kWidth) - 10, circle = column - 40;
    if (column < 0 || column >= 60) continue;
    // Signed circles are linear in inverse depth: 0 at 2 m, −40 at 1 m.
    picture.front.depth[i] = static_cast<float>(1 / (0.5 - 0.5 * circle / 40));
    picture.front.color[i] = kRed;
  }
  picture.behind = plane(kWidth, 60, 40, kBlue).front;
  const auto result = layered(picture, lens);
  for (std::size_t x = 40; x < 58; ++x) EXPECT_NEAR(result[30 * kWidth + x].r, 1, 0.01) << x;
}

TEST(Layered, WhatIsInFocusIsUntouched) {
  const DepthPicture picture = noise(83, 61, 2);
  expect_near(layered(picture, blurring(20, 83, 1)), picture.front.color, 1e-6F);
}

TEST(Layered, IsStepsBlurredAndLaidOverOneAnother) {
  for (const auto& [width, height] : {std::pair{1U, 1U}, {1U, 40U}, {40U, 1U}, {31U, 23U}}) {
    DepthPicture picture = noise(width, height, 2);
    scatter_depths(picture, 0.9F, 9);
    picture.behind = noise(width, height, 12).front;
    DepthPicture translucent = picture;
    for (Rgba& c : translucent.front.color) c.a = c.g;
    for (const std::size_t layers : {1U, 2U, 7U, 64U}) {
      const ThinLens lens = blurring(12, width, 1);
      const LayeredConfig config{.layers = layers, .largest_diameter = 20};
      expect_near(layered(picture, lens, config), slow_layered(picture, lens, config), 4e-6F);
      expect_near(layered(translucent, lens, config), slow_layered(translucent, lens, config),
                  4e-6F);
    }
  }
}

TEST(Layered, SharpForegroundDoesNotBleedIntoABlurredBackground) {
  DepthPicture picture = plane(120, 40, 9, kBlue);
  add_rectangle(picture, 40, 80, 0, 40, 2, kRed);
  picture.behind = plane(120, 40, 9, kBlue).front;
  const auto result = layered(picture, blurring(20, 120, 9));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const bool foreground = i % 120 >= 40 && i % 120 < 80;
    ASSERT_NEAR(result[i].r, foreground ? 1 : 0, 1e-4F) << i % 120;
    ASSERT_NEAR(result[i].b, foreground ? 0 : result[i].a, 1e-4F) << i % 120;
  }
}

TEST(Layered, BlurredForegroundHasASoftSilhouetteOnBothSides) {
  constexpr std::size_t kWidth = 160, kEdge = 80;
  DepthPicture picture = plane(kWidth, 40, 2, kBlue);
  add_rectangle(picture, 0, kEdge, 0, 40, 1, kRed);
  picture.behind = plane(kWidth, 40, 2, kBlue).front;
  const auto result = layered(picture, blurring(30, kWidth, 1));
  const Rgba* row = &result[20 * kWidth];
  // A box of the area of a disc of diameter 30 over the edge: a ramp.
  const double side = std::sqrt(std::numbers::pi) / 2 * 30;
  for (int d = -20; d < 20; ++d) {
    const double share = covered(std::clamp(0.5 - (d + 0.5) / side, 0.0, 1.0), tolerance_of(30));
    const Rgba& c = row[static_cast<int>(kEdge) + d];
    EXPECT_NEAR(c.r, share, 0.01) << d;
    EXPECT_NEAR(c.b, 1 - share, 0.01) << d;
  }
}

TEST(Layered, TransparentPicturesStayTransparent) {
  DepthPicture picture = plane(60, 50, 4, {});
  add_rectangle(picture, 20, 40, 15, 35, 4, {0.5F, 0, 0, 0.5F});
  const auto result = layered(picture, blurring(6, 60, 4));
  for (const Rgba& c : result) ASSERT_NEAR(c.r, c.a, 1e-6F);
  EXPECT_NEAR(result[25 * 60 + 30].a, 0.5, 1e-5);
  EXPECT_NEAR(result[0].a, 0, 1e-6);
}

TEST(Layered, DoesNotDependOnTheNumberOfThreads) {
  DepthPicture picture = noise(130, 110, 2);
  scatter_depths(picture, 0.8F, 30);
  const auto whole = layered(picture, blurring(20, 130, 1));
  const ThreadLimit one(1);
  EXPECT_EQ(layered(picture, blurring(20, 130, 1)), whole);
}

TEST(Layered, RefusesBadDepthAndLenses) {
  DepthPicture picture = plane(8, 8, 2);
  picture.front.depth[5] = -1;
  EXPECT_THROW((void)layered(picture, {}), ValueError);
  ThinLens lens;
  lens.f_number = 0;
  EXPECT_THROW((void)layered(plane(8, 8, 2), lens), ValueError);
  EXPECT_THROW((void)layered(DepthPicture{}, {}), ShapeError);
}

}  // namespace
}  // namespace relumbre
