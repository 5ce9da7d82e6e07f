#include "relumbre/dof/revealed.h"

#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::plane;

/// A picture of which something is known behind every pixel.
DepthPicture with_behind(std::size_t width, std::size_t height) {
  DepthPicture picture = plane(width, height, 1);
  picture.behind = plane(width, height, 2).front;
  return picture;
}

std::size_t count(const std::vector<std::uint8_t>& mask) {
  return std::accumulate(mask.begin(), mask.end(), std::size_t{0});
}

std::vector<std::uint8_t> revealed_by(const DepthPicture& picture, std::span<const float> front,
                                      std::span<const float> behind) {
  return revealed(picture, SurfaceEdges(front, picture.width, picture.height), front, behind);
}

TEST(Revealed, NothingWithoutASilhouette) {
  const DepthPicture picture = with_behind(40, 30);
  std::vector<float> front(picture.pixels());
  for (std::size_t i = 0; i < front.size(); ++i) front[i] = 3 * static_cast<float>(i % 40) - 90;
  EXPECT_EQ(count(revealed_by(picture, front, std::vector<float>(front.size(), 100))), 0U);
}

TEST(Revealed, AsFarAsHalfTheDifferenceOfTheCircles) {
  constexpr std::size_t kWidth = 80, kHeight = 11, kEdge = 50;
  const DepthPicture picture = with_behind(kWidth, kHeight);
  for (const float far : {-10.0F, 0.0F, 10.0F}) {
    std::vector<float> front(picture.pixels(), far);
    for (std::size_t i = 0; i < front.size(); ++i)
      if (i % kWidth < kEdge) front[i] = -20;
    const auto mask = revealed_by(picture, front, std::vector<float>(front.size(), far));
    const auto reach = static_cast<std::size_t>((far + 20) / 2);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      const std::size_t x = i % kWidth;
      EXPECT_EQ(mask[i], x < kEdge && x + reach >= kEdge ? 1 : 0) << far << " " << x;
    }
  }
}

TEST(Revealed, NotWhatLiesBehindAllThatIsSeenPastTheSilhouette) {
  constexpr std::size_t kWidth = 80, kEdge = 50;
  const DepthPicture picture = with_behind(kWidth, 5);
  std::vector<float> front(picture.pixels(), -4);
  for (std::size_t i = 0; i < front.size(); ++i)
    if (i % kWidth < kEdge) front[i] = -20;
  const auto shown = [&](float behind) {
    return count(revealed_by(picture, front, std::vector<float>(front.size(), behind)));
  };
  EXPECT_EQ(shown(-4), 5 * 8U);
  EXPECT_EQ(shown(-10), 5 * 5U);  // something between the two
  EXPECT_EQ(shown(12), 0U);       // the wall hides it there as well
}

TEST(Revealed, OnlyWhereItIsKnownWhatLiesBehind) {
  DepthPicture picture = with_behind(60, 7);
  std::vector<float> front(picture.pixels(), 5);
  for (std::size_t i = 0; i < front.size(); ++i)
    if (i % 60 < 30) front[i] = -25;
  for (std::size_t i = 0; i < front.size(); ++i)
    if (i / 60 < 3) picture.behind.depth[i] = 0;
  const auto mask = revealed_by(picture, front, std::vector<float>(front.size(), 5));
  EXPECT_EQ(count(mask), 4 * 15U);
  for (std::size_t i = 0; i < 3 * 60; ++i) EXPECT_EQ(mask[i], 0);
}

TEST(Revealed, InfinitelyFarIsKnown) {
  DepthPicture picture = with_behind(40, 1);
  std::ranges::fill(picture.behind.depth, std::numeric_limits<float>::infinity());
  std::vector<float> front(40, 8);
  std::fill_n(front.begin(), 20, -8.0F);
  EXPECT_EQ(count(revealed_by(picture, front, std::vector<float>(40, 8))), 8U);
}

TEST(Revealed, NothingBehindWhatIsInFocusBesideWhatIsNearer) {
  // Three surfaces from left to right, each farther away. The middle one is the farther side of
  // the first silhouette, which reveals nothing of what it hides.
  constexpr std::size_t kWidth = 100;
  const DepthPicture picture = with_behind(kWidth, 3);
  std::vector<float> front(picture.pixels()), behind(picture.pixels());
  for (std::size_t i = 0; i < front.size(); ++i) {
    const std::size_t x = i % kWidth;
    front[i] = x < 40 ? -20.0F : x < 70 ? 0.0F : 10.0F;
    behind[i] = x < 40 ? 0.0F : 10.0F;
  }
  const auto mask = revealed_by(picture, front, behind);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const std::size_t x = i % kWidth;
    EXPECT_EQ(mask[i], (x >= 30 && x < 40) || (x >= 65 && x < 70) ? 1 : 0) << x;
  }
}

/// Distances by sweeps are right to a tenth.
TEST(Revealed, IsWhatDistancesToAllSilhouettePixelsSay) {
  constexpr int kSize = 101;
  const DepthPicture picture = with_behind(kSize, kSize);
  std::vector<float> front(picture.pixels(), 12);
  const auto inside = [](int x, int y) { return std::hypot(x - 50, (y - 50) * 1.3) < 38; };
  const auto at = [](int x, int y) { return static_cast<std::size_t>(y * kSize + x); };
  std::vector<std::pair<int, int>> rim;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      if (!inside(x, y)) continue;
      front[at(x, y)] = -12;
      const bool edge =
          !inside(x - 1, y) || !inside(x + 1, y) || !inside(x, y - 1) || !inside(x, y + 1);
      if (edge) rim.emplace_back(x, y);
    }
  }
  const auto mask = revealed_by(picture, front, std::vector<float>(front.size(), 12));
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      double distance = 1e9;
      for (const auto& [u, v] : rim) distance = std::min(distance, 1 + std::hypot(x - u, y - v));
      if (!inside(x, y)) {
        EXPECT_EQ(mask[at(x, y)], 0);
      } else if (std::abs(distance - 12) > 1.2) {
        EXPECT_EQ(mask[at(x, y)], distance < 12 ? 1 : 0) << x << "," << y;
      }
    }
  }
}

TEST(Revealed, AwkwardSizesWork) {
  for (const auto& [width, height] :
       {std::pair{1U, 1U}, {2U, 1U}, {1U, 2U}, {1U, 50U}, {50U, 1U}}) {
    const DepthPicture picture = with_behind(width, height);
    std::vector<float> front(picture.pixels(), 9);
    front[0] = -9;
    const std::vector<float> behind(picture.pixels(), 9);
    EXPECT_EQ(count(revealed_by(picture, front, behind)), picture.pixels() > 1 ? 1U : 0U);
  }
}

}  // namespace
}  // namespace relumbre
