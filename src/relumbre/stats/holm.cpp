#include "relumbre/stats/holm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace relumbre {

std::vector<TailProbability> holm(std::span<const TailProbability> tests) {
  std::vector<std::size_t> order(tests.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return tests[i].log_p; });
  std::vector<TailProbability> adjusted(tests.size());
  TailProbability largest{0, -std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < order.size(); ++k) {
    const TailProbability& test = tests[order[k]];
    const auto factor = static_cast<double>(tests.size() - k);
    largest.p = std::max(largest.p, std::min(1.0, test.p * factor));
    largest.log_p = std::max(largest.log_p, std::min(0.0, test.log_p + std::log(factor)));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

}  // namespace relumbre
