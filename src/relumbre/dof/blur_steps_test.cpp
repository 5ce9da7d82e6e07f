#include "relumbre/dof/blur_steps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

constexpr std::pair<float, float> kRanges[] = {{-129, 45}, {-9.4F, 21.5F}, {3, 512},
                                               {-512, -7}, {-0.3F, 0.2F},  {0, 30}};

TEST(BlurSteps, AscendFromTheLeastToTheLargest) {
  for (const auto& [least, largest] : kRanges) {
    for (const std::size_t count : {1U, 2U, 7U, 64U, 256U}) {
      const std::vector<float> steps = blur_steps(least, largest, count);
      EXPECT_EQ(steps.front(), least);
      EXPECT_EQ(steps.back(), largest);
      EXPECT_LE(steps.size(), count + 2);
      EXPECT_EQ(std::ranges::adjacent_find(steps, std::greater_equal()), steps.end());
    }
  }
}

TEST(BlurSteps, HoldWhatIsInFocus) {
  for (const std::size_t count : {1U, 5U, 64U}) {
    const std::vector<float> steps = blur_steps(-40, 20, count);
    EXPECT_NE(std::ranges::find(steps, 0.0F), steps.end());
  }
}

TEST(BlurSteps, HaveWholeRadiiBetweenTheEnds) {
  for (const auto& [least, largest] : kRanges) {
    const std::vector<float> steps = blur_steps(least, largest, 64);
    for (std::size_t i = 1; i + 1 < steps.size(); ++i) {
      const float radius = box_radius_of(steps[i]);
      EXPECT_NEAR(radius, std::round(radius), 1e-4F) << steps[i];
    }
  }
}

TEST(BlurSteps, GrowWithTheBlur) {
  const std::vector<float> steps = blur_steps(0, 400, 64);
  float before = 0;
  for (std::size_t i = 1; i + 1 < steps.size(); ++i) {
    const float step = box_radius_of(steps[i]) - box_radius_of(steps[i - 1]);
    EXPECT_GE(step, 0.99F);
    EXPECT_GE(step, before - 1.01F);  // radii are rounded
    EXPECT_LE(step, 1.5F + 0.1F * box_radius_of(steps[i]));
    before = step;
  }
}

TEST(BlurSteps, AreOneForOneBlur) {
  EXPECT_EQ(blur_steps(12.25F, 12.25F, 64), std::vector<float>{12.25F});
  EXPECT_EQ(blur_steps(0, 0, 1), std::vector<float>{0});
}

TEST(BlurSteps, ABoxHasTheAreaOfTheDisc) {
  for (const float diameter : {2.0F, -7.5F, 100.0F}) {
    const double side = 2 * static_cast<double>(box_radius_of(diameter)) + 1;
    EXPECT_NEAR(side * side, std::numbers::pi / 4 * static_cast<double>(diameter * diameter),
                1e-3 * side * side);
  }
  EXPECT_EQ(box_radius_of(1), 0);
}

TEST(BlurSteps, RefuseNone) { EXPECT_THROW((void)blur_steps(0, 1, 0), ValueError); }

}  // namespace
}  // namespace relumbre
