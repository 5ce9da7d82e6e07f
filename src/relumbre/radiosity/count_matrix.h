/// U as a dense table of ray counts, in the formats of the real-time stage.
///
///   table     row 0: c_00 c_01 ... c_0,k-1 | row 1: c_10 ...      n·k entries, no padding
///   overflow  (row, column, excess), by row                       counts beyond the format's limit
///
/// Entry c_ip of the matrix is the table's entry plus the excess listed for it, if any. So 8-bit
/// and 16-bit tables are exact, and so is float32 up to 2^24 rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/huge_array.h"
#include "relumbre/radiosity/count_kernels.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/radiosity/sparse_counts.h"

namespace relumbre {

/// Immutable; all functions are thread-safe.
class CountMatrix {
 public:
  /// O(n·k) time and memory. The counts must be valid. Throws ValueError if the table would exceed
  /// 2^46 bytes, std::bad_alloc.
  CountMatrix(const SparseCounts& counts, CountFormat format,
              const RowKernels& kernels = best_row_kernels());

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::uint32_t rays() const { return rays_; }
  [[nodiscard]] CountFormat format() const { return format_; }
  /// Bytes of table and overflow that a product reads.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t row_bytes() const;

  /// Writes the counts of a row as the products see them. values.size() = columns().
  void decode_row(std::size_t row, std::span<double> values) const;

  /// A product needs the vectors y (three of columns() values, one after the other) in packed form:
  /// operand_bytes() bytes, aligned to kOperandAlignment.
  [[nodiscard]] std::size_t operand_bytes() const { return product_.operand_bytes(columns_); }
  void pack(const float* y, std::byte* operand) const { product_.pack(y, columns_, operand); }
  /// out[3·(i - first) + c] = Σ_p c_ip·y_cp for the rows first ≤ i < last. Error about 1e-7 of
  /// Σ_p c_ip · max|y|. Reads (last - first)·row_bytes().
  void multiply(std::size_t first, std::size_t last, const float* y, const std::byte* operand,
                float* out) const;

 private:
  struct Excess {
    std::uint32_t row, column;
    float count;
  };
  [[nodiscard]] const std::byte* row(std::size_t i) const {
    return table_.data() + i * row_bytes();
  }
  void encode(const SparseCounts& counts);
  template <class T>
  void encode_as(const SparseCounts& counts, std::uint32_t limit);
  [[nodiscard]] std::span<const Excess> excess_of(std::size_t first, std::size_t last) const;

  std::size_t rows_, columns_;
  std::uint32_t rays_;
  CountFormat format_;
  RowProduct product_;
  HugeBuffer table_;
  std::vector<Excess> overflow_;
};

}  // namespace relumbre
