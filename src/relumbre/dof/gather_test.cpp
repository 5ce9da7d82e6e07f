#include "relumbre/dof/gather.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/slow_box_testing.h"
#include "relumbre/dof/spread.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::add_rectangle, test::blurring, test::expect_near, test::kBlue, test::kRed, test::noise,
    test::plane, test::scatter_depths, test::slow_box;

TEST(Gather, ConstantPictureStaysConstant) {
  DepthPicture picture = plane(83, 61, 2);
  scatter_depths(picture, 1, 9);
  expect_near(gather(picture, blurring(20, 83, 1)), picture.front.color, 1e-6F);
}

TEST(Gather, WhatIsInFocusIsUntouched) {
  const DepthPicture picture = noise(83, 61, 2);
  expect_near(gather(picture, blurring(20, 83, 1)), picture.front.color, 1e-6F);
}

TEST(Gather, IsTheMeanOfASquareAroundEachPixel) {
  for (const auto& [width, height] : {std::pair{1U, 1U}, {1U, 40U}, {40U, 1U}, {31U, 23U}}) {
    DepthPicture picture = noise(width, height, 2);
    scatter_depths(picture, 0.7F, 40);
    for (Rgba& c : picture.front.color) c.a = c.r;
    picture.front.depth[0] = std::numeric_limits<float>::infinity();
    for (const double blur : {3.0, 17.3}) {
      const ThinLens lens = blurring(blur, width, 1);
      std::vector<float> radii = circles_of_confusion(picture.front.depth, lens, width, 25);
      for (float& r : radii) r = std::max((std::abs(r) - 1) / 2, 0.0F);
      expect_near(gather(picture, lens, 25), slow_box(picture.front.color, width, height, radii),
                  2e-6F);
    }
  }
}

TEST(Gather, DoesNotDependOnTheNumberOfThreads) {
  DepthPicture picture = noise(130, 210, 2);
  scatter_depths(picture, 0.8F, 30);
  const auto whole = gather(picture, blurring(20, 130, 1));
  const ThreadLimit one(1);
  EXPECT_EQ(gather(picture, blurring(20, 130, 1)), whole);
}

/// Why it is only the baseline.
TEST(Gather, LetsASharpForegroundBleedAndSpreadDoesNot) {
  DepthPicture picture = plane(120, 40, 40, kBlue);
  add_rectangle(picture, 40, 80, 0, 40, 2, kRed);
  const ThinLens lens = blurring(20, 120, 40);
  const std::size_t beside = 20 * 120 + 84;  // of the background
  EXPECT_GT(gather(picture, lens)[beside].r, 0.2);
  EXPECT_NEAR(spread(picture, lens)[beside].r, 0, 1e-4);
}

TEST(Gather, GivesABlurredForegroundAHardOutlineAndSpreadDoesNot) {
  DepthPicture picture = plane(160, 40, 2, kBlue);
  add_rectangle(picture, 0, 80, 0, 40, 1, kRed);
  const ThinLens lens = blurring(30, 160, 1);
  const std::size_t beside = 20 * 160 + 82;  // of the background, which is in focus
  EXPECT_NEAR(gather(picture, lens)[beside].r, 0, 1e-6);
  EXPECT_GT(spread(picture, lens)[beside].r, 0.3);
}

TEST(Gather, RefusesBadDepthAndLenses) {
  DepthPicture picture = plane(8, 8, 2);
  picture.front.depth[5] = std::nanf("");
  EXPECT_THROW((void)gather(picture, {}), ValueError);
  ThinLens lens;
  lens.f_number = 0;
  EXPECT_THROW((void)gather(plane(8, 8, 2), lens), ValueError);
  EXPECT_THROW((void)gather(DepthPicture{}, {}), ShapeError);
}

}  // namespace
}  // namespace relumbre
