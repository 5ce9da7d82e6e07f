/// How far two bakes are apart. For tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "relumbre/radiosity/sparse_counts.h"

namespace relumbre {

/// Rays that are counted in another column; those that are lost or won count half. Of counts of the
/// same shape.
inline std::uint64_t rays_counted_otherwise(const SparseCounts& a, const SparseCounts& b) {
  std::uint64_t sum = 0;
  std::vector<std::int64_t> row(a.columns);
  for (std::size_t i = 0; i < a.rows(); ++i) {
    for (std::size_t e = 0; e < a.row_columns(i).size(); ++e)
      row[a.row_columns(i)[e]] += a.row_counts(i)[e];
    for (std::size_t e = 0; e < b.row_columns(i).size(); ++e)
      row[b.row_columns(i)[e]] -= b.row_counts(i)[e];
    for (std::int64_t& d : row) sum += static_cast<std::uint64_t>(std::abs(d)), d = 0;
  }
  return (sum + 1) / 2;
}

}  // namespace relumbre
