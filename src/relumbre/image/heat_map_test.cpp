#include "relumbre/image/heat_map.h"

#include <array>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

TEST(HeatMap, ColoursGrowFromBlackToWhite) {
  EXPECT_EQ(heat_color(0), Rgb(0));
  EXPECT_EQ(heat_color(1), Rgb(1));
  EXPECT_EQ(heat_color(7), Rgb(1));
  for (float v = 0.1F; v < 0.99F; v += 0.01F) {
    EXPECT_LE(heat_color(v).x, heat_color(v + 0.01F).x);
    EXPECT_LE(heat_color(v).y, heat_color(v + 0.01F).y);
  }
  EXPECT_GT(heat_color(0.1F).z, 0.2F);
}

TEST(HeatMap, PixelsAreRelativeToTheLargestValue) {
  const std::array<std::string, 4> names{"R", "G", "B", "reads"};
  Image image(3, 1, names);
  const auto reads = image.channel("reads");
  reads[0] = 0, reads[1] = 20, reads[2] = 40;
  paint_heat(image, "reads");
  EXPECT_EQ(image.rgb(0), Rgb(0));
  EXPECT_EQ(image.rgb(1), heat_color(0.5F));
  EXPECT_EQ(image.rgb(2), Rgb(1));
}

TEST(HeatMap, APictureOfZerosIsBlack) {
  const std::array<std::string, 4> names{"R", "G", "B", "reads"};
  Image image(2, 2, names);
  paint_heat(image, "reads");
  EXPECT_EQ(image.rgb(3), Rgb(0));
}

}  // namespace
}  // namespace relumbre
