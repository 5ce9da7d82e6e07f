#include "relumbre/radiosity/sparse_counts.h"

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

void validate_offsets(const SparseCounts& counts) {
  if (counts.row_offsets.empty() || counts.row_offsets.front() != 0) {
    throw ValueError("counts: row offsets do not begin with 0");
  }
  if (counts.column.size() != counts.count.size()) {
    throw ValueError(
        fmt::format("counts: {} columns but {} counts", counts.column.size(), counts.count.size()));
  }
  for (std::size_t row = 0; row < counts.rows(); ++row) {
    if (counts.row_offsets[row + 1] < counts.row_offsets[row]) {
      throw ValueError(fmt::format("counts: row {} ends before it begins", row));
    }
  }
  if (counts.row_offsets.back() != counts.column.size()) {
    throw ValueError(fmt::format("counts: rows end at {} but there are {} entries",
                                 counts.row_offsets.back(), counts.column.size()));
  }
}

void validate_row(const SparseCounts& counts, std::size_t row) {
  const auto columns = counts.row_columns(row);
  const auto hits = counts.row_counts(row);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] >= counts.columns) {
      throw ValueError(
          fmt::format("counts: row {} has column {} of {}", row, columns[i], counts.columns));
    }
    if (i > 0 && columns[i] <= columns[i - 1]) {
      throw ValueError(fmt::format("counts: row {} has columns out of order", row));
    }
    if (hits[i] == 0) throw ValueError(fmt::format("counts: row {} has a count of 0", row));
    sum += hits[i];
  }
  if (sum > counts.rays) {
    throw ValueError(fmt::format("counts: row {} has {} hits of {} rays", row, sum, counts.rays));
  }
}

}  // namespace

void validate(const SparseCounts& counts) {
  validate_offsets(counts);
  for (std::size_t row = 0; row < counts.rows(); ++row) validate_row(counts, row);
}

}  // namespace relumbre
