/// Ranks, with ties.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace relumbre {

struct Ranks {
  std::vector<double> ranks;  ///< from 1; equal values share the mean of their ranks
  double ties = 0;            ///< Σ (t³ − t) over runs of t equal values
};

/// O(n log n). The values must not be NaN.
Ranks rank(std::span<const double> values);

}  // namespace relumbre
