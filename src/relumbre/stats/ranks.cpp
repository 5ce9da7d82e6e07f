#include "relumbre/stats/ranks.h"

#include <algorithm>
#include <numeric>

namespace relumbre {

Ranks rank(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  Ranks result{std::vector<double>(values.size()), 0};
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    const auto run = static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i)
      result.ranks[order[i]] = static_cast<double>(begin + end + 1) / 2;
    result.ties += run * run * run - run;
  }
  return result;
}

}  // namespace relumbre
