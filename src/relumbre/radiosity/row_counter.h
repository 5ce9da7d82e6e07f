/// Counts how often each column is hit, and gives the counts back in ascending order.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/radiosity/sparse_counts.h"

namespace relumbre {

/// One row of counts, dense while it is filled. Two levels of bits say which counts are not zero,
/// so that no sorting is needed and a flush costs O(non-zeros + columns / 4096).
///
///   summary_  bit w: word w of used_ is not 0
///   used_     bit c: column c was hit
///   counts_   c: how often
class RowCounter {
 public:
  explicit RowCounter(std::size_t columns)
      : counts_(columns), used_(columns / 64 + 1), summary_(columns / 4096 + 1) {}

  void add(std::uint32_t column) {
    ++counts_[column];  // no branch on it being the first: that is anyone's guess
    used_[column >> 6] |= std::uint64_t{1} << (column & 63);
    summary_[column >> 12] |= std::uint64_t{1} << ((column >> 6) & 63);
  }

  /// Appends the row to `rows` and starts afresh.
  void flush(SparseCounts& rows) {
    for (std::size_t s = 0; s < summary_.size(); ++s) {
      for (; summary_[s] != 0; summary_[s] &= summary_[s] - 1) {
        flush_word(64 * s + static_cast<std::size_t>(std::countr_zero(summary_[s])), rows);
      }
    }
    rows.row_offsets.push_back(rows.column.size());
  }

 private:
  void flush_word(std::size_t w, SparseCounts& rows) {
    for (; used_[w] != 0; used_[w] &= used_[w] - 1) {
      const std::size_t column = 64 * w + static_cast<std::size_t>(std::countr_zero(used_[w]));
      rows.column.push_back(static_cast<std::uint32_t>(column));
      rows.count.push_back(counts_[column]);
      counts_[column] = 0;
    }
  }

  std::vector<std::uint32_t> counts_;
  std::vector<std::uint64_t> used_, summary_;
};

}  // namespace relumbre
