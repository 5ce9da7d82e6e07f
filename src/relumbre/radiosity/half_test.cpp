#include "relumbre/radiosity/half.h"

#include <cmath>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

TEST(Half, HoldsIntegersTo2048) {
  for (int i = -2048; i <= 2048; ++i)
    EXPECT_EQ(static_cast<float>(Half(static_cast<float>(i))), static_cast<float>(i));
}

TEST(Half, RoundsToNearestEven) {
  EXPECT_EQ(static_cast<float>(Half(2049.0F)), 2048.0F);
  EXPECT_EQ(static_cast<float>(Half(2051.0F)), 2052.0F);
  EXPECT_EQ(static_cast<float>(Half(4095.0F)), 4096.0F);
  EXPECT_EQ(static_cast<float>(Half(65504.0F)), 65504.0F);
  EXPECT_EQ(static_cast<float>(Half(0x1p-14F)), 0x1p-14F);
}

TEST(Half, RoundsWithin2ToTheMinus11) {
  for (float x = 0.001F; x < 65000.0F; x *= 1.0173F)
    EXPECT_LE(std::abs(static_cast<float>(Half(x)) - x), x * 0x1p-11F);
}

}  // namespace
}  // namespace relumbre
