#include "relumbre/octree/voxel_value.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

TEST(VoxelValue, ColoursAreWithinAThousandthOfTheLargestComponent) {
  RandomStream random(3);
  for (int i = 0; i < 20'000; ++i) {
    const float scale = std::exp2(24 * random.uniform() - 9);
    const Rgb color(scale * random.uniform(), scale * random.uniform(), scale * random.uniform());
    const Rgb unpacked = unpack_color(pack_color(color));
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(unpacked[c], color[c], max_component(color) / 510) << i;
  }
}

TEST(VoxelValue, StoredColoursAreKept) {
  for (const Rgb& color : {Rgb(0), Rgb(1), Rgb(0.5F, 0.25F, 0.125F), Rgb(65408, 0, 128)})
    EXPECT_EQ(unpack_color(pack_color(color)), color);
  EXPECT_EQ(unpack_color(pack_color(Rgb(511.9F / 512))), Rgb(1));  // rounds up to another exponent
}

TEST(VoxelValue, ColoursOutOfRangeAreClamped) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(unpack_color(pack_color({-1, nan, 1})), Rgb(0, 0, 1));
  EXPECT_EQ(unpack_color(pack_color({infinity, 0, 1e9F})), Rgb(65408, 0, 65408));
}

TEST(VoxelValue, NormalsAreWithinATenThousandth) {
  RandomStream random(4);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3f n = normalized(
        Vec3f(random.uniform() - 0.5F, random.uniform() - 0.5F, random.uniform() - 0.5F));
    EXPECT_LT(length(unpack_normal(pack_normal(n * 7.0F)) - n), 1e-4F) << i;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (const float sign : {-1.0F, 1.0F}) {
      Vec3f n;
      n[a] = sign;
      EXPECT_LT(length(unpack_normal(pack_normal(n)) - n), 1e-4F);
    }
  }
}

VoxelValue mean_of(const std::vector<std::array<Vec3f, 2>>& colors_and_normals) {
  VoxelMean mean;
  for (const auto& [color, normal] : colors_and_normals) mean.add(color, std::nullopt, normal, 1);
  return mean.value();
}

TEST(VoxelMean, TheFacesOfAThinBoardKeepTheirColours) {
  const Rgb red(1, 0, 0), blue(0, 0, 1);
  const Vec3f up(0, 0, 1), down(0, 0, -1);
  const VoxelValue board = mean_of({{red, up}, {blue, down}, {blue, down}});
  EXPECT_EQ(unpack_color(board.color), red);
  EXPECT_EQ(unpack_color(board.back), blue);
  EXPECT_EQ(unpack_normal(board.normal), up);
}

TEST(VoxelMean, WhatIsSeenFromOneSideIsSeenFromBoth) {
  const VoxelValue sheet = mean_of({{Rgb(1, 0, 0), Vec3f(0, 1, 0)}, {Rgb(0, 1, 0), {1, 1, 0}}});
  EXPECT_EQ(sheet.back, VoxelValue::kNoBack);
  EXPECT_EQ(back_color(sheet), unpack_color(sheet.color));
  EXPECT_EQ(unpack_color(sheet.color), Rgb(0.5F, 0.5F, 0));
}

TEST(VoxelMean, TheNormalPointsToASideThatIsKnown) {
  VoxelMean first, second, all;
  first.add(Rgb(1), std::nullopt, {0, 0, 1}, 0);  // touches, and no more
  second.add(Rgb(0.5F), std::nullopt, {0, 0, -1}, 1);
  all.add(first), all.add(second);
  EXPECT_EQ(unpack_color(all.value().color), Rgb(0.5F));
}

TEST(VoxelMean, OfMeansIsThatOfAllTurnedAlike) {
  VoxelMean first, second, all;
  first.add(Rgb(1), Rgb(0.25F), {0, 0, 1}, 1);
  second.add(Rgb(0.25F), Rgb(0.5F), {0, 0, -1}, 3);
  all.add(first), all.add(second);
  const VoxelValue value = all.value();
  EXPECT_EQ(unpack_color(value.color), Rgb((1 + 3 * 0.5F) / 4));
  EXPECT_EQ(unpack_color(value.back), Rgb((0.25F + 3 * 0.25F) / 4));
  EXPECT_EQ(unpack_normal(value.normal), Vec3f(0, 0, 1));
}

TEST(VoxelValue, NoNormalStaysNone) {
  EXPECT_EQ(unpack_normal(pack_normal({})), Vec3f());
  EXPECT_EQ(unpack_normal(pack_normal(Vec3f(std::numeric_limits<float>::infinity()))), Vec3f());
  EXPECT_EQ(unpack_normal(VoxelValue{}.normal), Vec3f());
}

}  // namespace
}  // namespace relumbre
