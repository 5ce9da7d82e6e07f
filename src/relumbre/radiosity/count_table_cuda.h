/// U on a device: the formats of count_matrix.h, rows padded.
#pragma once

#include <cstddef>
#include <cstdint>

#include "relumbre/cuda/memory.h"
#include "relumbre/radiosity/relight_operator.h"

namespace relumbre::cuda {

/// A count beyond the table's format.
struct ExcessCount {
  std::uint32_t row, column;
  float count;
};

/// A table of 8-bit or 16-bit counts with the list of what is beyond them, or of half-precision
/// floats. kFloat32 is not one of the device's formats.
class CountTable {
 public:
  /// `counts` must be valid. Throws ValueError for kFloat32.
  CountTable(const SparseCounts& counts, CountFormat format, const Stream& stream);
  ~CountTable();
  CountTable(CountTable&&) noexcept;

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] CountFormat format() const { return format_; }
  [[nodiscard]] std::size_t row_bytes() const { return row_bytes_; }
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] const unsigned char* data() const { return table_.data(); }
  [[nodiscard]] const ExcessCount* excess() const { return excess_.data(); }
  /// Of tiles of 16 rows.
  [[nodiscard]] const std::uint32_t* excess_offsets() const { return excess_offsets_.data(); }

  /// Of a table with these sizes, without its list.
  static std::size_t table_bytes(std::size_t rows, std::size_t columns, CountFormat format);

 private:
  void fill(const SparseCounts& counts, const Stream& stream);
  void list_excess(const SparseCounts& counts, const Stream& stream);

  std::size_t rows_, columns_, row_bytes_;
  CountFormat format_;
  DeviceArray<unsigned char> table_;
  DeviceArray<ExcessCount> excess_;
  DeviceArray<std::uint32_t> excess_offsets_;
};

}  // namespace relumbre::cuda
