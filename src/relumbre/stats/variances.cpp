#include "relumbre/stats/variances.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/stats/median.h"

namespace relumbre {

namespace {

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double squares_about(std::span<const double> values, double centre) {
  double sum = 0;
  for (const double v : values) sum += (v - centre) * (v - centre);
  return sum;
}

}  // namespace

VarianceTest brown_forsythe(std::span<const double> values, const Factor& factor) {
  Groups groups = comparable_groups(values, factor);
  std::vector<double> all;
  for (std::vector<double>& group : groups.values) {
    const double median = median_of(group);
    for (double& v : group) v = std::abs(v - median);
    all.insert(all.end(), group.begin(), group.end());
  }
  const double grand = mean_of(all);
  double between = 0, within = 0;
  for (const std::vector<double>& group : groups.values) {
    const double mean = mean_of(group);
    between += static_cast<double>(group.size()) * (mean - grand) * (mean - grand);
    within += squares_about(group, mean);
  }
  VarianceTest test;
  test.df1 = static_cast<double>(groups.values.size() - 1);
  test.df2 = static_cast<double>(all.size() - groups.values.size());
  if (!(within > 0))
    throw ValueError(
        fmt::format("factor {}: deviations from the medians do not vary within any "
                    "level, Brown-Forsythe's test is not defined",
                    factor.name));
  test.statistic = (between / test.df1) / (within / test.df2);
  test.p = fisher_tail(test.statistic, test.df1, test.df2);
  return test;
}

VarianceTest bartlett(std::span<const double> values, const Factor& factor) {
  const Groups groups = comparable_groups(values, factor);
  const auto k = static_cast<double>(groups.values.size());
  const double df = static_cast<double>(values.size()) - k;
  double pooled = 0, reciprocals = 0;
  std::vector<double> degrees, variances;
  for (std::size_t g = 0; g < groups.values.size(); ++g) {
    const std::vector<double>& group = groups.values[g];
    const double n1 = static_cast<double>(group.size()) - 1;
    const double squares = squares_about(group, mean_of(group));
    if (!(n1 > 0 && squares > 0))
      throw ValueError(
          fmt::format("factor {}: level \"{}\" has no variance, Bartlett's test is not defined",
                      factor.name, factor.levels[groups.levels[g]]));
    pooled += squares / df;
    reciprocals += 1 / n1;
    degrees.push_back(n1);
    variances.push_back(squares / n1);
  }
  double logs = 0;  // of ratios, so that nothing cancels where variances are nearly equal
  for (std::size_t g = 0; g < degrees.size(); ++g)
    logs += degrees[g] * std::log(pooled / variances[g]);
  VarianceTest test;
  test.df1 = k - 1;
  test.statistic = std::max(0.0, logs) / (1 + (reciprocals - 1 / df) / (3 * (k - 1)));
  test.p = chi_squared_tail(test.statistic, test.df1);
  return test;
}

}  // namespace relumbre
