#include "relumbre/stats/kruskal_wallis.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "relumbre/stats/holm.h"
#include "relumbre/stats/ranks.h"

namespace relumbre {

namespace {

/// The groups of values and their mean ranks among all values.
struct RankedGroups {
  Groups groups;
  std::vector<double> mean_ranks;
  double n = 0, ties = 0;
};

RankedGroups rank_groups(std::span<const double> values, const Factor& factor) {
  RankedGroups result{comparable_groups(values, factor), {}, static_cast<double>(values.size())};
  const Ranks ranks = rank(values);
  result.ties = ranks.ties;
  for (const std::vector<double>& group : groups_of(ranks.ranks, factor))
    if (!group.empty())
      result.mean_ranks.push_back(std::accumulate(group.begin(), group.end(), 0.0) /
                                  static_cast<double>(group.size()));
  return result;
}

double size_of(const std::vector<double>& group) { return static_cast<double>(group.size()); }

/// a and b are sorted.
double delta_of_sorted(std::span<const double> a, std::span<const double> b) {
  double greater = 0, less = 0;
  auto below = b.begin(), not_above = b.begin();
  for (const double x : a) {
    while (below != b.end() && *below < x) ++below;
    while (not_above != b.end() && *not_above <= x) ++not_above;
    greater += static_cast<double>(below - b.begin());
    less += static_cast<double>(b.end() - not_above);
  }
  return (greater - less) / (static_cast<double>(a.size()) * static_cast<double>(b.size()));
}

}  // namespace

KruskalWallis kruskal_wallis(std::span<const double> values, const Factor& factor) {
  const RankedGroups ranked = rank_groups(values, factor);
  const double n = ranked.n;
  double squares = 0;
  for (std::size_t g = 0; g < ranked.mean_ranks.size(); ++g) {
    const double d = ranked.mean_ranks[g] - (n + 1) / 2;
    squares += size_of(ranked.groups.values[g]) * d * d;
  }
  KruskalWallis result;
  result.df = static_cast<double>(ranked.mean_ranks.size() - 1);
  result.h = 12 / (n * (n + 1)) * squares / (1 - ranked.ties / (n * n * n - n));
  result.p = chi_squared_tail(result.h, result.df);
  result.epsilon2 = result.h / (n - 1);
  return result;
}

std::vector<DunnPair> dunn(std::span<const double> values, const Factor& factor) {
  RankedGroups ranked = rank_groups(values, factor);
  std::vector<std::vector<double>>& groups = ranked.groups.values;
  for (std::vector<double>& group : groups) std::ranges::sort(group);
  const double n = ranked.n;
  const double variance = n * (n + 1) / 12 - ranked.ties / (12 * (n - 1));
  std::vector<DunnPair> pairs;
  std::vector<TailProbability> tests;
  for (std::size_t i = 0; i < groups.size(); ++i)
    for (std::size_t j = i + 1; j < groups.size(); ++j) {
      DunnPair pair{ranked.groups.levels[i], ranked.groups.levels[j]};
      pair.z = (ranked.mean_ranks[i] - ranked.mean_ranks[j]) /
               std::sqrt(variance * (1 / size_of(groups[i]) + 1 / size_of(groups[j])));
      pair.p = normal_two_sided(pair.z);
      pair.cliffs_delta = delta_of_sorted(groups[i], groups[j]);
      tests.push_back(pair.p);
      pairs.push_back(pair);
    }
  const std::vector<TailProbability> adjusted = holm(tests);
  for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k].adjusted = adjusted[k];
  return pairs;
}

double cliffs_delta(std::span<const double> a, std::span<const double> b) {
  std::vector<double> x(a.begin(), a.end()), y(b.begin(), b.end());
  std::ranges::sort(x);
  std::ranges::sort(y);
  return delta_of_sorted(x, y);
}

}  // namespace relumbre
