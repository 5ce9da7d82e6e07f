#include "relumbre/dof/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

/// Fragments in no order; their coverage is their number.
std::vector<Fragment> some_fragments(std::size_t count, std::size_t height) {
  std::vector<Fragment> fragments(count);
  RandomStream random(count);
  for (std::size_t i = 0; i < count; ++i) {
    fragments[i].y = static_cast<std::uint32_t>(random.bits() % height);
    fragments[i].coc = 90 * random.uniform() * random.uniform() - 20;
    fragments[i].coverage = static_cast<float>(i);
  }
  return fragments;
}

TEST(DepthLayers, HoldEveryFragmentOnce) {
  for (const std::size_t layers : {1U, 2U, 24U, 256U}) {
    const auto fragments = some_fragments(1009, 37);
    const DepthLayers result = sort_into_layers(fragments, 37, layers);
    EXPECT_EQ(result.layers, layers);
    EXPECT_EQ(result.height, 37U);
    ASSERT_EQ(result.fragments.size(), fragments.size());
    std::vector<bool> found(fragments.size());
    for (const Fragment& f : result.fragments) {
      const auto number = static_cast<std::size_t>(f.coverage);
      EXPECT_FALSE(found[number]);
      found[number] = true;
      EXPECT_EQ(f.coc, fragments[number].coc);
      EXPECT_EQ(f.y, fragments[number].y);
    }
  }
}

TEST(DepthLayers, LieBetweenBounds) {
  const auto fragments = some_fragments(3001, 13);
  const std::vector<std::vector<float>> cases = {
      {-20, 0, 1.5F, 30, 90}, {-5, 5, 6}, {-20, 90}, {3}};
  for (const std::vector<float>& bounds : cases) {
    const DepthLayers result = sort_between(fragments, 13, bounds);
    ASSERT_EQ(result.layers, std::max<std::size_t>(bounds.size() - 1, 1));
    ASSERT_EQ(result.fragments.size(), fragments.size());
    for (std::size_t layer = 0; layer < result.layers; ++layer) {
      for (std::size_t y = 0; y < 13; ++y) {
        for (const Fragment& f : result.rows(layer, y, y + 1)) {
          EXPECT_EQ(f.y, y);
          EXPECT_TRUE(layer == 0 || f.coc >= bounds[layer]);
          EXPECT_TRUE(layer + 1 == result.layers || f.coc < bounds[layer + 1]);
        }
      }
    }
  }
}

TEST(DepthLayers, GoFromFrontToBackInEqualSteps) {
  constexpr std::size_t kLayers = 24;
  const auto fragments = some_fragments(5000, 11);
  const auto [least, largest] = std::ranges::minmax(fragments, {}, &Fragment::coc);
  const float step = (largest.coc - least.coc) / kLayers;
  const DepthLayers result = sort_into_layers(fragments, 11, kLayers);
  float before = -std::numeric_limits<float>::infinity();
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    float last = before;
    for (const Fragment& f : result.rows(layer, 0, 11)) {
      EXPECT_GE(f.coc, before);
      EXPECT_GE(f.coc, least.coc + static_cast<float>(layer) * step - 1e-4F);
      EXPECT_LE(f.coc, least.coc + static_cast<float>(layer + 1) * step + 1e-4F);
      last = std::max(last, f.coc);
    }
    before = last;
  }
}

TEST(DepthLayers, AreSortedByRowAndStable) {
  constexpr std::size_t kHeight = 13, kLayers = 7;
  const DepthLayers result = sort_into_layers(some_fragments(3001, kHeight), kHeight, kLayers);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    const Fragment* last = nullptr;
    for (const Fragment& f : result.rows(layer, 0, kHeight)) {
      if (last != nullptr) {
        EXPECT_LE(last->y, f.y);
        if (last->y == f.y) {
          EXPECT_LT(last->coverage, f.coverage);
        }
      }
      last = &f;
    }
  }
}

TEST(DepthLayers, RowsAreThoseOfTheLayer) {
  constexpr std::size_t kHeight = 13, kLayers = 5;
  const DepthLayers result = sort_into_layers(some_fragments(997, kHeight), kHeight, kLayers);
  std::size_t count = 0;
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    EXPECT_TRUE(result.rows(layer, 4, 4).empty());
    for (std::size_t y = 0; y < kHeight; ++y) {
      for (const Fragment& f : result.rows(layer, y, y + 1)) EXPECT_EQ(f.y, y);
      count += result.rows(layer, y, y + 1).size();
    }
  }
  EXPECT_EQ(count, 997U);
}

TEST(DepthLayers, KnowHowFarTheyReach) {
  const DepthLayers result = sort_into_layers(some_fragments(997, 13), 13, 9);
  for (std::size_t layer = 0; layer < 9; ++layer) {
    float reach = 0;
    for (const Fragment& f : result.rows(layer, 0, 13)) reach = std::max(reach, std::abs(f.coc));
    EXPECT_EQ(result.reach[layer], reach);
  }
}

TEST(DepthLayers, OneDepthIsOneLayer) {
  for (const float coc : {-3.0F, 0.0F, 5.0F}) {
    std::vector<Fragment> fragments = some_fragments(100, 10);
    for (Fragment& f : fragments) f.coc = coc;
    const DepthLayers result = sort_into_layers(fragments, 10, 24);
    EXPECT_EQ(result.rows(0, 0, 10).size(), 100U);
    EXPECT_EQ(result.reach[0], std::abs(coc));
    for (std::size_t layer = 1; layer < 24; ++layer) {
      EXPECT_TRUE(result.rows(layer, 0, 10).empty());
      EXPECT_EQ(result.reach[layer], 0);
    }
  }
}

TEST(DepthLayers, OneFragmentIsEnough) {
  const DepthLayers result = sort_into_layers(some_fragments(1, 1), 1, 24);
  EXPECT_EQ(result.rows(0, 0, 1).size(), 1U);
}

}  // namespace
}  // namespace relumbre
