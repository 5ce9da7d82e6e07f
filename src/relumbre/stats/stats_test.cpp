// Laws, hand-checkable cases and bad input. Agreement with other programs: reference_test.cpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/stats/anova.h"
#include "relumbre/stats/holm.h"
#include "relumbre/stats/kruskal_wallis.h"
#include "relumbre/stats/median.h"
#include "relumbre/stats/normality.h"
#include "relumbre/stats/orthonormal_basis.h"
#include "relumbre/stats/ranks.h"
#include "relumbre/stats/variances.h"

namespace relumbre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Factor factor(const std::string& name, std::initializer_list<std::string> labels) {
  return make_factor(name, std::vector<std::string>(labels));
}

std::vector<double> random_values(std::size_t n, unsigned seed, double step = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  for (double& v : values) v = step > 0 ? std::floor(normal(random) / step) * step : normal(random);
  return values;
}

/// n rows of factors with these numbers of levels, drawn at random.
Table random_table(std::size_t n, const std::vector<std::size_t>& levels, unsigned seed) {
  Table table{"y", random_values(n, seed), {}};
  std::mt19937 random(seed + 1);
  for (std::size_t f = 0; f < levels.size(); ++f) {
    Factor& made = table.factors.emplace_back();
    made.name = std::string(1, static_cast<char>('a' + f));
    for (std::size_t k = 0; k < levels[f]; ++k) made.levels.push_back(std::to_string(k));
    for (std::size_t i = 0; i < n; ++i)
      made.rows.push_back(static_cast<std::uint32_t>(random() % levels[f]));
  }
  return table;
}

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Factor, LevelsAreInTheOrderTheyAppear) {
  const Factor made = factor("depth", {"9", "10", "9", "8"});
  EXPECT_THAT(made.levels, ElementsAre("9", "10", "8"));
  EXPECT_THAT(made.rows, ElementsAre(0, 1, 0, 2));
}

TEST(Ranks, EqualValuesShareTheMeanOfTheirRanks) {
  const Ranks ranks = rank(std::vector<double>{3, 1, 3, 2, 3});
  EXPECT_THAT(ranks.ranks, ElementsAre(4, 1, 4, 2, 4));
  EXPECT_EQ(ranks.ties, 24);
}

TEST(Ranks, SumToTheSumOfTheFirstNNumbers) {
  for (const std::size_t n : {0u, 1u, 2u, 97u}) {
    double sum = 0;
    for (const double r : rank(random_values(n, 5, 0.3)).ranks) sum += r;
    EXPECT_DOUBLE_EQ(sum, static_cast<double>(n * (n + 1)) / 2);
  }
}

TEST(Holm, MultipliesTheSmallestByAllAndNeverFalls) {
  const std::vector<TailProbability> tests{{0.01, std::log(0.01)},
                                           {0.04, std::log(0.04)},
                                           {0.03, std::log(0.03)},
                                           {0.005, std::log(0.005)}};
  const std::vector<TailProbability> adjusted = holm(tests);
  const double expected[] = {0.03, 0.06, 0.06, 0.02};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(adjusted[i].p, expected[i], 1e-15);
    EXPECT_NEAR(adjusted[i].log_p, std::log(expected[i]), 1e-14);
  }
}

TEST(Holm, NothingExceedsOne) {
  EXPECT_EQ(holm(std::vector<TailProbability>{{0.9, std::log(0.9)}, {0.8, std::log(0.8)}})[0].p, 1);
  EXPECT_TRUE(holm({}).empty());
}

TEST(Tails, LogarithmsGoOnWhereProbabilitiesUnderflow) {
  // χ² of 2 degrees of freedom: e^(−x/2) exactly.
  EXPECT_EQ(chi_squared_tail(4000, 2).p, 0);
  EXPECT_NEAR(chi_squared_tail(4000, 2).log_p, -2000, 1e-9);
  // F of 2 and m: (1 + 2 f / m)^(−m/2) exactly.
  EXPECT_EQ(fisher_tail(1e6, 2, 1000).p, 0);
  EXPECT_NEAR(fisher_tail(1e6, 2, 1000).log_p, -500 * std::log1p(2000), 1e-9);
  EXPECT_EQ(fisher_tail(std::numeric_limits<double>::infinity(), 2, 9).p, 0);
}

TEST(Tails, LogarithmsAreContinuousWhereTheMethodChanges) {
  double before = 0;
  for (double x = 1300; x < 1360; x += 0.25) {  // e^(−x/2) passes 1e-290
    const double now = chi_squared_tail(x, 7).log_p;
    if (before != 0) {
      EXPECT_NEAR(now - before, -0.125, 0.001) << x;
    }
    before = now;
  }
}

TEST(Tails, NormalQuantileInvertsTheTail) {
  for (const double z : {-3.0, -0.5, 0.0, 1.25, 4.0})
    EXPECT_NEAR(normal_quantile(1 - normal_upper(z).p), z, 1e-10);
  EXPECT_NEAR(normal_two_sided(-1.959963984540054).p, 0.05, 1e-15);
}

TEST(Basis, IsOrthonormalAndDropsWhatItSpans) {
  OrthonormalBasis basis;
  EXPECT_TRUE(basis.add({1, 1, 1, 1}));
  EXPECT_TRUE(basis.add({1, 2, 3, 4}));
  EXPECT_FALSE(basis.add({5, 7, 9, 11}));
  EXPECT_FALSE(basis.add({0, 0, 0, 0}));
  EXPECT_TRUE(basis.add({1, 4, 9, 16}));
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> along = basis.coordinates(basis[i]);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(along[j], i == j, 1e-15);
  }
}

TEST(Anova, OneWayByHand) {
  const Table table{"y", {1, 2, 3, 5, 6, 7}, {factor("g", {"a", "a", "a", "b", "b", "b"})}};
  const Anova result = anova(table);
  EXPECT_NEAR(result.terms[0].ss, 24, 1e-12);
  EXPECT_NEAR(result.residual_ss, 4, 1e-12);
  EXPECT_EQ(result.residual_df, 4u);
  EXPECT_NEAR(result.terms[0].f, 24, 1e-12);
  EXPECT_NEAR(result.terms[0].eta2, 24.0 / 28, 1e-14);
  EXPECT_NEAR(result.terms[0].omega2, 23.0 / 29, 1e-14);
  EXPECT_THAT(result.residuals, testing::Pointwise(testing::DoubleNear(1e-14),
                                                   std::vector<double>{-1, 0, 1, -1, 0, 1}));
}

TEST(Anova, ResidualsAreOrthogonalToEveryLevel) {
  const Table table = random_table(211, {2, 3, 5}, 4);
  const Anova result = anova(table);
  for (const Factor& f : table.factors)
    for (const std::vector<double>& group : groups_of(result.residuals, f)) {
      double sum = 0;
      for (const double r : group) sum += r;
      EXPECT_NEAR(sum, 0, 1e-12);
    }
}

TEST(Anova, SumsOfABalancedTableAddUpToTheTotal) {
  Table table{"y", random_values(2 * 3 * 4 * 3, 8), {}};
  for (const std::size_t levels : {2u, 3u, 4u}) {
    std::vector<std::string> labels;
    for (std::size_t i = 0; i < table.values.size(); ++i) {
      const std::size_t stride = levels == 2 ? 1 : levels == 3 ? 2 : 6;
      labels.push_back(std::to_string(i / stride % levels));
    }
    table.factors.push_back(make_factor(std::to_string(levels), labels));
  }
  const Anova result = anova(table, {.interactions = true});
  double ss = result.residual_ss;
  std::size_t df = result.residual_df;
  for (const AnovaTerm& term : result.terms) {
    ss += term.ss;
    df += term.df;
  }
  EXPECT_NEAR(ss, result.total_ss, 1e-11);
  EXPECT_EQ(df, result.total_df);
}

TEST(Anova, AShiftAndAScaleOfTheResponseChangeNoF) {
  Table table = random_table(97, {3, 4}, 6);
  const Anova before = anova(table, {.interactions = true});
  for (double& v : table.values) v = 1e7 + 1e3 * v;
  const Anova after = anova(table, {.interactions = true});
  for (std::size_t t = 0; t < before.terms.size(); ++t)
    EXPECT_NEAR(after.terms[t].f / before.terms[t].f, 1, 1e-9);
}

TEST(Anova, EmptyCellsTakeDegreesOfFreedomFromTheInteraction) {
  Table table = random_table(400, {3, 4}, 9);
  Table kept{"y", {}, table.factors};
  for (Factor& f : kept.factors) f.rows.clear();
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    if (table.factors[0].rows[i] == 2 && table.factors[1].rows[i] == 3) continue;
    kept.values.push_back(table.values[i]);
    for (std::size_t f = 0; f < 2; ++f) kept.factors[f].rows.push_back(table.factors[f].rows[i]);
  }
  EXPECT_EQ(anova(table, {.interactions = true}).terms[2].df, 6u);
  EXPECT_EQ(anova(kept, {.interactions = true}).terms[2].df, 5u);
}

TEST(Anova, LevelsWithoutRowsDoNotMatter) {
  Table table = random_table(60, {3}, 10);
  const Anova before = anova(table);
  table.factors[0].levels.push_back("never");
  EXPECT_EQ(anova(table).terms[0].df, before.terms[0].df);
  EXPECT_EQ(kruskal_wallis(table.values, table.factors[0]).df, 2);
}

TEST(Anova, RefusesBadTablesInOneLine) {
  const Factor two = factor("g", {"a", "a", "b", "b"});
  const auto refusal = [](const Table& table) { return message_of([&] { anova(table); }); };
  EXPECT_THAT(refusal({"y", {}, {}}), HasSubstr("y: there are no rows"));
  EXPECT_THAT(refusal({"y", {1, 2}, {}}), HasSubstr("no factors"));
  EXPECT_THAT(refusal({"y", {1, 2, NAN, 4}, {two}}), HasSubstr("row 2 is nan"));
  EXPECT_THAT(refusal({"y", {1, 2, 3, INFINITY}, {two}}), HasSubstr("row 3 is inf"));
  EXPECT_THAT(refusal({"y", {3, 3, 3, 3}, {two}}), HasSubstr("all 4 rows are 3"));
  EXPECT_THAT(refusal({"y", {1, 2, 3}, {two}}), HasSubstr("g has 4 rows, the response 3"));
  EXPECT_THAT(refusal({"y", {1, 2}, {factor("g", {"a", "a"})}}), HasSubstr("one level, \"a\""));
  EXPECT_THAT(refusal({"y", {1, 2, 3, 4}, {two, two}}), HasSubstr("two factors are named g"));
  EXPECT_THAT(refusal({"y", {1, 2}, {factor("g", {"a", "b"})}}), HasSubstr("2 rows are too few"));
  EXPECT_THAT(refusal({"y", {1, 1, 2, 2}, {two}}), HasSubstr("explains every row exactly"));
  Factor twin = two;
  twin.name = "h";
  EXPECT_THAT(refusal({"y", {1, 2, 4, 3}, {two, twin}}), HasSubstr("cannot be told"));
  Factor broken = two;
  broken.rows[1] = 2;
  EXPECT_THAT(refusal({"y", {1, 2, 3, 4}, {broken}}), HasSubstr("row 1 has level 2 of 2"));
}

TEST(Anova, RefusesModelsThatAreTooLarge) {
  Table table{"y", {}, {}};
  std::vector<std::string> a, b;
  for (int i = 0; i < 40000; ++i) {
    table.values.push_back(i);
    a.push_back(std::to_string(i % 140));
    b.push_back(std::to_string(i / 300));
  }
  table.factors = {make_factor("a", a), make_factor("b", b)};
  EXPECT_THAT(message_of([&] { anova(table, {.interactions = true}); }), HasSubstr("exceeds"));
}

TEST(Anova, RefusesModelsThatWouldTakeMinutes) {
  const Table table = random_table(9800, {70, 70, 2}, 5);
  EXPECT_EQ(message_of([&] { anova(table); }), "no error");
  EXPECT_THAT(message_of([&] { anova(table, {.interactions = true}); }),
              HasSubstr("operations, more than 2e+11"));
}

/// Wants to stop once it was asked so many times.
class StopAtQuestion : public Progress {
 public:
  explicit StopAtQuestion(int questions) : left_(questions) {}
  [[nodiscard]] bool cancelled() const override { return --left_ <= 0; }

 private:
  mutable int left_;
};

TEST(Anova, HearsThatItShouldStopAtEveryParameter) {
  const Table table = random_table(200, {4, 3, 3}, 6);  // 1 + 7 main + 16 interaction parameters
  for (const int question : {1, 9, 40, 60})
    EXPECT_THROW((void)anova(table, {.interactions = true}, StopAtQuestion(question)), Cancelled)
        << question;
}

TEST(Median, IsTheMiddleOrTheMeanOfTheTwoInTheMiddle) {
  EXPECT_EQ(median_of({7}), 7);
  EXPECT_EQ(median_of({3, 1}), 2);
  EXPECT_EQ(median_of({9, 1, 4}), 4);
  EXPECT_EQ(median_of({10, 2, 1, 4}), 3);
}

TEST(ShapiroWilk, IsOneForThreeEvenlySpacedValues) {
  const NormalityTest test = shapiro_wilk(std::vector<double>{1, 2, 3});
  EXPECT_NEAR(test.statistic, 1, 1e-12);
  EXPECT_NEAR(test.p.p, 1, 1e-6);
}

TEST(ShapiroWilk, IsBlindToShiftScaleAndOrder) {
  std::vector<double> values = random_values(101, 12);
  const double w = shapiro_wilk(values).statistic;
  for (double& v : values) v = 5 - 3 * v;
  std::ranges::reverse(values);
  EXPECT_NEAR(shapiro_wilk(values).statistic, w, 1e-13);
}

TEST(ShapiroWilk, RefusesWhatItIsNotDefinedFor) {
  EXPECT_THAT(message_of([] { shapiro_wilk(random_values(2, 1)); }), HasSubstr("needs 3 or more"));
  EXPECT_THAT(message_of([] { shapiro_wilk(random_values(5001, 1)); }), HasSubstr("at most 5000"));
  EXPECT_THAT(message_of([] { shapiro_wilk(std::vector<double>(9, 2.0)); }),
              HasSubstr("all values are 2"));
  EXPECT_THAT(message_of([] { shapiro_wilk(std::vector<double>{1, NAN, 3}); }), HasSubstr("nan"));
  EXPECT_GT(shapiro_wilk(random_values(5000, 1)).statistic, 0.99);
}

TEST(DAgostinoPearson, TellsANormalSampleFromASkewedOne) {
  std::vector<double> values = random_values(1000, 3);
  EXPECT_GT(dagostino_pearson(values).p.p, 0.01);
  for (double& v : values) v = std::exp(v);
  EXPECT_LT(dagostino_pearson(values).p.p, 1e-50);
  EXPECT_THAT(message_of([] { dagostino_pearson(random_values(19, 1)); }), HasSubstr("20 or more"));
}

TEST(NormalScores, AreSymmetricAndGrow) {
  const std::vector<double> scores = normal_scores(7);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(scores[i], -scores[6 - i], 1e-14);
  EXPECT_TRUE(std::ranges::is_sorted(scores));
}

TEST(Variances, RefuseGroupsWithoutVariance) {
  const Factor g = factor("g", {"a", "a", "b", "b"});
  const std::vector<double> constant_group{1, 2, 3, 3}, constant_groups{1, 1, 3, 3};
  EXPECT_THAT(message_of([&] { bartlett(constant_group, g); }), HasSubstr("\"b\" has no variance"));
  EXPECT_THAT(message_of([&] { brown_forsythe(constant_groups, g); }), HasSubstr("not defined"));
}

TEST(Variances, EqualSpreadsGiveAStatisticOfZero) {
  const Factor g = factor("g", {"a", "a", "a", "b", "b", "b"});
  const std::vector<double> values{1, 2, 4, 11, 12, 14};
  EXPECT_NEAR(bartlett(values, g).statistic, 0, 1e-12);
  EXPECT_NEAR(brown_forsythe(values, g).statistic, 0, 1e-12);
  EXPECT_NEAR(bartlett(values, g).p.p, 1, 1e-5);
}

TEST(KruskalWallis, SeparatedGroupsByHand) {
  const Factor g = factor("g", {"a", "a", "b", "b"});
  const KruskalWallis result = kruskal_wallis(std::vector<double>{1, 2, 3, 4}, g);
  EXPECT_NEAR(result.h, 2.4, 1e-14);
  EXPECT_NEAR(result.epsilon2, 0.8, 1e-14);
  EXPECT_EQ(result.df, 1);
}

TEST(KruskalWallis, SeesOnlyTheOrder) {
  const Table table = random_table(83, {4}, 21);
  std::vector<double> stretched = table.values;
  for (double& v : stretched) v = std::exp(v) + v;
  EXPECT_EQ(kruskal_wallis(stretched, table.factors[0]).h,
            kruskal_wallis(table.values, table.factors[0]).h);
}

TEST(Dunn, OfTwoLevelsIsKruskalWallis) {
  const Table table = random_table(31, {2}, 33);
  const DunnPair pair = dunn(table.values, table.factors[0]).at(0);
  const KruskalWallis all = kruskal_wallis(table.values, table.factors[0]);
  EXPECT_NEAR(pair.z * pair.z, all.h, 1e-12);
  EXPECT_NEAR(pair.p.p, all.p.p, 1e-12);
  EXPECT_EQ(pair.adjusted.p, pair.p.p);
}

TEST(CliffsDelta, MatchesCountingEveryPair) {
  const std::vector<double> a = random_values(23, 41, 0.5), b = random_values(31, 42, 0.5);
  double count = 0;
  for (const double x : a)
    for (const double y : b) count += (x > y) - (x < y);
  EXPECT_DOUBLE_EQ(cliffs_delta(a, b), count / (23 * 31));
  EXPECT_DOUBLE_EQ(cliffs_delta(b, a), -cliffs_delta(a, b));
}

TEST(RankTests, RefuseOneLevelAndNan) {
  const Factor one = factor("g", {"a", "a"});
  EXPECT_THAT(message_of([&] {
                kruskal_wallis(std::vector<double>{1, 2}, one);
              }),
              HasSubstr("factor g has one level"));
  EXPECT_THAT(message_of([&] {
                dunn(std::vector<double>{1, NAN}, factor("g", {"a", "b"}));
              }),
              HasSubstr("row 1 is nan"));
  EXPECT_THAT(message_of([&] {
                kruskal_wallis({}, Factor{"g", {"a"}, {}});
              }),
              HasSubstr("no rows"));
}

}  // namespace
}  // namespace relumbre
