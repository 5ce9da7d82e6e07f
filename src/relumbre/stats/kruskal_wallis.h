/// Do groups differ? A test by ranks, which needs no normal distribution.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/stats/distributions.h"
#include "relumbre/stats/table.h"

namespace relumbre {

struct KruskalWallis {
  double h = 0;            ///< corrected for ties
  double df = 0;           ///< levels that have rows, less 1
  TailProbability p = {};  ///< of an H as large if all levels had one distribution, by χ²
  double epsilon2 = 0;  ///< effect size ε² = H / (n − 1): 0 none, 1 ranks are the levels' alone
};

/// O(n log n). Throws as comparable_groups.
/// Source: Kruskal and Wallis 1952; Tomczak and Tomczak 2014 (ε²).
KruskalWallis kruskal_wallis(std::span<const double> values, const Factor& factor);

/// Two levels compared.
struct DunnPair {
  std::uint32_t a = 0, b = 0;     ///< levels, a < b
  double z = 0;                   ///< positive where a's mean rank is the greater
  TailProbability p = {};         ///< two-sided
  TailProbability adjusted = {};  ///< by Holm, over all pairs of the factor
  double cliffs_delta = 0;        ///< P(a > b) − P(a < b) of a row of each: −1…1
};

/// Every pair of levels, by Dunn's test with its correction for ties, after Kruskal-Wallis.
/// O(n log n + n·levels). Throws as comparable_groups.
/// Source: Dunn 1964; Holm 1979; Cliff 1993.
std::vector<DunnPair> dunn(std::span<const double> values, const Factor& factor);

/// P(x > y) − P(x < y) over all pairs of an x of a and a y of b. O(n log n). Neither is empty.
double cliffs_delta(std::span<const double> a, std::span<const double> b);

}  // namespace relumbre
