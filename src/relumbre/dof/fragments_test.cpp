#include "relumbre/dof/fragments.h"

#include <numeric>

#include <gtest/gtest.h>

#include "relumbre/dof/revealed.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::add_rectangle, test::noise, test::plane;

std::vector<float> random_circles(std::size_t count) {
  std::vector<float> circles(count);
  RandomStream random(count);
  for (float& circle : circles) circle = 30 * random.uniform() - 10;
  return circles;
}

TEST(Fragments, OfAPlaneAreItsPixelsRowByRow) {
  const DepthPicture picture = noise(23, 17, 2);
  std::vector<float> front(picture.pixels());
  for (std::size_t i = 0; i < front.size(); ++i)
    front[i] = 4 + 0.25F * static_cast<float>(i % 23) - 0.5F * static_cast<float>(i / 23);
  const std::vector<Fragment> fragments = fragments_of(picture, front, {});
  ASSERT_EQ(fragments.size(), picture.pixels());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const Fragment& f = fragments[i];
    EXPECT_EQ(f.y * 23 + f.x, i);
    EXPECT_EQ(f.coc, front[i]);
    EXPECT_EQ(f.coverage, 1);
    EXPECT_EQ(f.color, picture.front.color[i]);
    EXPECT_NEAR(f.slope.x, 0.25, 1e-5);
    EXPECT_NEAR(f.slope.y, -0.5, 1e-5);
  }
}

TEST(Fragments, OfAPixelAddUpToIt) {
  const DepthPicture picture = noise(31, 29, 2);
  const std::vector<Fragment> fragments =
      fragments_of(picture, random_circles(picture.pixels()), {});
  EXPECT_GT(fragments.size(), picture.pixels());
  std::vector<Rgba> sum(picture.pixels());
  std::vector<float> coverage(picture.pixels());
  for (const Fragment& f : fragments) {
    Rgba& c = sum[f.y * 31 + f.x];
    c = {c.r + f.color.r, c.g + f.color.g, c.b + f.color.b, c.a + f.color.a};
    coverage[f.y * 31 + f.x] += f.coverage;
    EXPECT_GT(f.coverage, 0);
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    EXPECT_NEAR(coverage[i], 1, 1e-6F);
    EXPECT_NEAR(sum[i].r, picture.front.color[i].r, 2e-6F);
    EXPECT_NEAR(sum[i].g, picture.front.color[i].g, 2e-6F);
    EXPECT_NEAR(sum[i].b, picture.front.color[i].b, 2e-6F);
    EXPECT_NEAR(sum[i].a, picture.front.color[i].a, 2e-6F);
  }
}

TEST(Fragments, WhatLiesBehindIsAddedWhereItIsRevealed) {
  DepthPicture picture = plane(70, 20, 2, {0, 0, 1, 1});
  add_rectangle(picture, 0, 40, 0, 20, 1, {1, 0, 0, 1});
  picture.behind = noise(70, 20, 2).front;
  std::vector<float> front(picture.pixels(), 0.0F);
  for (std::size_t i = 0; i < front.size(); ++i)
    if (i % 70 < 40) front[i] = -20;
  std::vector<float> behind(picture.pixels());
  for (std::size_t i = 0; i < behind.size(); ++i) behind[i] = 0.025F * static_cast<float>(i % 70);

  const std::vector<std::uint8_t> shown =
      revealed(picture, SurfaceEdges(front, picture.width, picture.height), front, behind);
  const std::vector<Fragment> fragments = fragments_of(picture, front, behind);
  const std::size_t hidden = std::accumulate(shown.begin(), shown.end(), std::size_t{0});
  EXPECT_GT(hidden, 0U);
  EXPECT_EQ(fragments.size(), picture.pixels() + hidden);
  for (std::size_t k = 1; k < fragments.size(); ++k) {
    const Fragment &f = fragments[k], &before = fragments[k - 1];
    if (f.x != before.x || f.y != before.y) continue;
    const std::size_t i = f.y * 70 + f.x;
    EXPECT_EQ(shown[i], 1);
    EXPECT_EQ(f.coc, behind[i]);
    EXPECT_EQ(f.coverage, 1);
    EXPECT_EQ(f.color, picture.behind.color[i]);
    EXPECT_NEAR(f.slope.x, 0.025, 1e-5);
  }
}

}  // namespace
}  // namespace relumbre
