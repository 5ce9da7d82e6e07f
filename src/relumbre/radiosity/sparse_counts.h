/// Exact ray counts, compressed by rows: U (elements × patches) and F (elements × elements).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace relumbre {

/// Row i holds how many of `rays` rays shot from element i arrived at each column.
///
///   row_offsets  0 ──────► nnz of row 0 ──────► ... ──► nnz      (rows + 1)
///   column       ascending within a row                          (nnz)
///   count        ≥ 1                                             (nnz)
///
/// F_ij = count / rays; Σ_j count ≤ rays, the rest escaped or met the back of a one-sided surface.
struct SparseCounts {
  std::uint64_t columns = 0;
  std::uint32_t rays = 0;  ///< per row
  std::vector<std::uint64_t> row_offsets{0};
  std::vector<std::uint32_t> column;
  std::vector<std::uint32_t> count;

  [[nodiscard]] std::size_t rows() const { return row_offsets.size() - 1; }
  [[nodiscard]] std::uint64_t nonzeros() const { return column.size(); }
  [[nodiscard]] std::span<const std::uint32_t> row_columns(std::size_t row) const {
    return std::span(column).subspan(row_offsets[row], row_offsets[row + 1] - row_offsets[row]);
  }
  [[nodiscard]] std::span<const std::uint32_t> row_counts(std::size_t row) const {
    return std::span(count).subspan(row_offsets[row], row_offsets[row + 1] - row_offsets[row]);
  }
};

/// Checks every invariant stated above. Throws ValueError saying which row breaks which.
void validate(const SparseCounts& counts);

}  // namespace relumbre
