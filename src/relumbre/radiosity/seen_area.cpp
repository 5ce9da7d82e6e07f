#include "relumbre/radiosity/seen_area.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

std::vector<float> seen_area(const SparseCounts& counts, std::span<const float> area) {
  if (area.size() != counts.rows()) {
    throw ShapeError(fmt::format("{} areas for {} elements", area.size(), counts.rows()));
  }
  constexpr double kUnseen = 1e-6;
  std::vector<float> seen(area.size());
  for (std::size_t i = 0; i < area.size(); ++i) {
    const auto row = counts.row_counts(i);
    const auto arrived =
        static_cast<double>(std::accumulate(row.begin(), row.end(), std::uint64_t{0}));
    const double fraction = std::max(arrived / counts.rays, kUnseen);
    seen[i] = static_cast<float>(static_cast<double>(area[i]) * fraction);
  }
  return seen;
}

}  // namespace relumbre
