#include "relumbre/dof/focus.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::add_rectangle, test::plane;

constexpr float kInf = std::numeric_limits<float>::infinity();
const ThinLens kLens{
    .focal_length_mm = 50, .f_number = 2, .focus_distance_m = 1.05, .sensor_width_mm = 36};

TEST(CirclesOfConfusion, FollowTheFormulaByHand) {
  // f² (z − z_f) / (z N (z_f − f)): 0.625 mm at 2.1 m, −1.25 mm at 0.525 m, 1.25 mm at infinity.
  const std::vector<float> depth{2.1F, 0.525F, 1.05F, kInf, 0};
  const std::vector<float> circles = circles_of_confusion(depth, kLens, 3600, 2048);
  EXPECT_NEAR(circles[0], 62.5, 1e-4);
  EXPECT_NEAR(circles[1], -125, 1e-4);
  EXPECT_NEAR(circles[2], 0, 1e-4);
  EXPECT_NEAR(circles[3], 125, 1e-4);
  EXPECT_EQ(circles[4], 0);  // not known
}

TEST(CirclesOfConfusion, AreLimitedEitherWay) {
  const std::vector<float> depth{1e-30F, 0.2F, 2.1F, kInf};
  const std::vector<float> circles = circles_of_confusion(depth, kLens, 3600, 70);
  EXPECT_EQ(circles[0], -70);
  EXPECT_EQ(circles[1], -70);
  EXPECT_NEAR(circles[2], 62.5, 1e-4);
  EXPECT_EQ(circles[3], 70);
}

TEST(CirclesOfConfusion, AreLinearInInverseDepth) {
  std::vector<float> depth;
  for (int i = 1; i <= 100; ++i) depth.push_back(50 / static_cast<float>(i));
  const std::vector<float> circles = circles_of_confusion(depth, kLens, 1280, 1e6);
  const float step = circles[1] - circles[0];
  for (std::size_t i = 2; i < circles.size(); ++i)
    EXPECT_NEAR(circles[i] - circles[i - 1], step, 1e-3);
}

TEST(CirclesOfConfusion, RefuseWhatNoLensHas) {
  ThinLens lens = kLens;
  lens.f_number = 0;
  EXPECT_THROW((void)circles_of_confusion(std::vector<float>{1}, lens, 10, 100), ValueError);
  lens = kLens;
  lens.focus_distance_m = 0.05;
  EXPECT_THROW((void)circles_of_confusion({}, lens, 10, 100), ValueError);
}

TEST(AutomaticFocus, IsTheDepthOfWhatIsInTheMiddle) {
  DepthPicture picture = plane(160, 90, 20);
  add_rectangle(picture, 50, 110, 20, 70, 3, {1, 0, 0, 1});
  EXPECT_EQ(automatic_focus(picture), 3);
  // What lies in the corners does not count, however near.
  add_rectangle(picture, 0, 20, 0, 90, 0.5F, {1, 0, 0, 1});
  add_rectangle(picture, 140, 160, 0, 90, 0.5F, {1, 0, 0, 1});
  EXPECT_EQ(automatic_focus(picture), 3);
}

TEST(AutomaticFocus, IgnoresASpeckAndWhereThereIsNothing) {
  DepthPicture picture = plane(160, 90, kInf);
  add_rectangle(picture, 60, 100, 25, 65, 4, {1, 0, 0, 1});
  add_rectangle(picture, 78, 82, 43, 47, 1, {1, 0, 0, 1});
  EXPECT_EQ(automatic_focus(picture), 4);
}

TEST(AutomaticFocus, WorksAtAwkwardSizes) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 300}, {300, 1}, {2, 2}}) {
    const DepthPicture picture =
        plane(static_cast<std::size_t>(width), static_cast<std::size_t>(height), 7);
    EXPECT_EQ(automatic_focus(picture), 7);
  }
}

TEST(AutomaticFocus, NeedsSomethingToLookAt) {
  EXPECT_THROW((void)automatic_focus(plane(8, 8, kInf)), ValueError);
}

TEST(FocusOverlay, IsGreyInFocusRedBeforeAndBlueBehind) {
  DepthPicture picture = plane(120, 10, 1.05F, {0.5F, 0.5F, 0.5F, 1});
  add_rectangle(picture, 40, 80, 0, 10, 0.7F, {0.5F, 0.5F, 0.5F, 1});
  add_rectangle(picture, 80, 120, 0, 10, kInf, {0.5F, 0.5F, 0.5F, 1});
  const Image image = focus_overlay(picture, kLens);
  ASSERT_EQ(image.width(), 120U);
  ASSERT_EQ(image.height(), 10U);
  const Rgb sharp = image.rgb(5), before = image.rgb(60), behind = image.rgb(100);
  EXPECT_NEAR(sharp.x, 0.5, 1e-6);
  EXPECT_EQ(sharp.x, sharp.y);
  EXPECT_EQ(sharp.y, sharp.z);
  EXPECT_GT(before.x, 1.3F * before.z);
  EXPECT_GT(behind.z, 1.3F * behind.x);
}

TEST(FocusOverlay, IsMoreColourfulWithMoreBlur) {
  DepthPicture picture = plane(1280, 1, 1.05F, {0.5F, 0.5F, 0.5F, 1});
  for (std::size_t x = 0; x < 1280; ++x)
    picture.front.depth[x] = 1.2F + 0.001F * static_cast<float>(x);
  const Image image = focus_overlay(picture, kLens);
  for (std::size_t x = 1; x < 1280; ++x) {
    const Rgb last = image.rgb(x - 1), here = image.rgb(x);
    EXPECT_GE(here.z - here.x, last.z - last.x - 1e-6F);
  }
}

}  // namespace
}  // namespace relumbre
