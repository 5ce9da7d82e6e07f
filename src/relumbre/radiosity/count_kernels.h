/// The inner loops of the real-time stage, compiled once per instruction set.
///
/// All of them read rows of a dense row-major table in place, whatever its element type, so that
/// the bytes that cross the memory bus are those of the table and no others. Rows follow each other
/// without padding; vector loads run past a row's end into the next one, where the operand holds
/// zeros, so kTablePadding bytes must be readable behind the last row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace relumbre {

inline constexpr std::size_t kTablePadding = 256;
/// Operands start at a multiple of this many bytes.
inline constexpr std::size_t kOperandAlignment = 64;

/// How far ahead to prefetch in a table that is read `group_bytes` of consecutive rows at a time: a
/// whole number of groups, so that every row is asked for equally early.
inline std::size_t prefetch_distance(std::size_t group_bytes) {
  constexpr std::size_t least = 16384;
  return group_bytes == 0 ? least : (least + group_bytes - 1) / group_bytes * group_bytes;
}

/// Asks for a line of a table that will be read shortly, into the second-level cache: the
/// processor's own prefetching leaves up to two thirds of the memory's bandwidth idle (see
/// docs/decisions/0011-integer-dot-products.md). Beyond a table's end it does nothing. Inlined
/// always, or GCC takes a call that only prefetches for one without effect, and drops it.
[[gnu::always_inline]] inline void prefetch_table(const void* at, std::size_t distance) {
  const auto ahead = reinterpret_cast<std::uintptr_t>(at) + distance;
  __builtin_prefetch(reinterpret_cast<const void*>(ahead), 0, 2);
}

/// out[r·channels + c] = Σ_p table[r·columns + p] · y[c·columns + p], for every row r < rows.
/// A row's result has the same bits whatever rows are asked for together with it.
struct RowProduct {
  /// Size of the form in which `multiply` wants y; a multiple of kOperandAlignment.
  std::size_t (*operand_bytes)(std::size_t columns);
  void (*pack)(const float* y, std::size_t columns, std::byte* operand);
  void (*multiply)(const void* table, std::size_t rows, std::size_t columns,
                   const std::byte* operand, float* out);
};

/// One instruction set's kernels. Table entries are multiplied exactly as they are; sums are
/// accurate to about 1e-6 of Σ|table|·max|y|.
struct RowKernels {
  std::string_view name;
  RowProduct float32, float16, uint16, uint8;  ///< three channels: U
  RowProduct one_float32, one_uint16;          ///< one channel: M
  /// sum[c] = Σ_i weight[i] · rgb[3·i + c]. Not finite if any rgb is not.
  void (*weighted_sum)(const float* rgb, const float* weight, std::size_t count, float* sum);
};

/// The kernels for the best instruction set that this CPU has.
const RowKernels& best_row_kernels();

/// Every set of kernels that this CPU can run, best first, for tests. Not thread-safe.
std::vector<RowKernels> available_row_kernels();

}  // namespace relumbre
