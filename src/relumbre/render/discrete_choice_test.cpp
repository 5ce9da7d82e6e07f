#include "relumbre/render/discrete_choice.h"

#include <gtest/gtest.h>

namespace relumbre {
namespace {

TEST(DiscreteChoice, IntervalsAreAsLongAsTheWeights) {
  const DiscreteChoice choice(std::vector<float>{1, 0, 3, 4, 0});
  std::vector<int> counts(5);
  constexpr int kPoints = 8000;
  for (int i = 0; i < kPoints; ++i) {
    const auto [index, rest] = choice.choose((static_cast<float>(i) + 0.5F) / kPoints);
    ++counts[index];
    EXPECT_GE(rest, 0);
    EXPECT_LT(rest, 1);
  }
  EXPECT_EQ(counts, (std::vector<int>{1000, 0, 3000, 4000, 0}));
}

TEST(DiscreteChoice, NeverChoosesWeightZero) {
  const DiscreteChoice choice(std::vector<float>{0, 0, 1e-30F, 0, 1, 0, 0});
  EXPECT_EQ(choice.choose(0).index, 2U);
  EXPECT_EQ(choice.choose(kBelowOne).index, 4U);
}

TEST(DiscreteChoice, RestIsThePlaceWithin) {
  const DiscreteChoice choice(std::vector<float>{1, 1});
  EXPECT_FLOAT_EQ(choice.choose(0.25F).rest, 0.5F);
  EXPECT_FLOAT_EQ(choice.choose(0.875F).rest, 0.75F);
}

TEST(DiscreteChoice, OfNothingHasNoTotal) {
  EXPECT_EQ(DiscreteChoice().total(), 0);
  EXPECT_EQ(DiscreteChoice(std::vector<float>{0, 0}).total(), 0);
}

}  // namespace
}  // namespace relumbre
