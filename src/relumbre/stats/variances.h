/// Do groups have equal variances?
#pragma once

#include <span>

#include "relumbre/stats/distributions.h"
#include "relumbre/stats/table.h"

namespace relumbre {

struct VarianceTest {
  double statistic = 0;
  double df1 = 0, df2 = 0;  ///< df2 only where the statistic is an F
  TailProbability p = {};   ///< of a statistic as large if variances were equal
};

/// Levene's test with medians instead of means, which holds for skewed values too: the F of a
/// one-way analysis of |value − its group's median|. O(n log n).
/// Throws as comparable_groups; ValueError where every group is constant, or none has two rows.
/// Source: Brown and Forsythe 1974.
VarianceTest brown_forsythe(std::span<const double> values, const Factor& factor);

/// Bartlett's test: χ² with the groups' number less 1 degrees of freedom. Sharper than
/// Brown-Forsythe where values are normal, misleading where they are not. O(n).
/// Throws as comparable_groups; ValueError where a level has one row, or no variance.
/// Source: Bartlett 1937.
VarianceTest bartlett(std::span<const double> values, const Factor& factor);

}  // namespace relumbre
