#include "relumbre/stats/median.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace relumbre {

double median_of(std::vector<double> values) {
  assert(!values.empty());
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace relumbre
