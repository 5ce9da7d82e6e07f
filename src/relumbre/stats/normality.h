/// Do values come from a normal distribution?
#pragma once

#include <span>
#include <vector>

#include "relumbre/stats/distributions.h"

namespace relumbre {

struct NormalityTest {
  double statistic = 0;
  TailProbability p = {};  ///< of a statistic as extreme if the values were normal
};

/// Shapiro and Wilk's W with Royston's approximations, 3 ≤ n ≤ 5000. O(n log n).
/// Throws ValueError for another n, values that are not finite, or values that are all equal.
/// Source: Shapiro and Wilk 1965; Royston 1995 (algorithm AS R94).
NormalityTest shapiro_wilk(std::span<const double> values);

/// D'Agostino and Pearson's K²: skewness and kurtosis at once, for any n ≥ 20. O(n).
/// Throws ValueError for fewer, values that are not finite, or values that are all equal.
/// Source: D'Agostino, Belanger and D'Agostino 1990.
NormalityTest dagostino_pearson(std::span<const double> values);

/// What the sorted values would be on average if they were standard normal, by Blom's
/// approximation Φ⁻¹((i − 3/8) / (n + 1/4)), i = 1…n: the abscissae of a Q-Q plot.
std::vector<double> normal_scores(std::size_t n);

}  // namespace relumbre
