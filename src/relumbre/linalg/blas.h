/// The single-precision BLAS products that the library uses, with the shapes checked.
#pragma once

#include <cstddef>
#include <span>

namespace relumbre {

/// A rows × columns matrix whose columns are contiguous: entry (i, j) is values[j·rows + i].
struct ColumnMajor {
  std::span<const float> values;
  std::size_t rows = 0, columns = 0;
};

enum class Transpose { kNo, kYes };

/// y = alpha·op(A)·x + beta·y. x and y must not overlap. One SGEMV: rows·columns·4 bytes read.
/// Throws ShapeError if the lengths disagree, ValueError where a side exceeds 2^31 - 1.
void gemv(Transpose op, float alpha, const ColumnMajor& a, std::span<const float> x, float beta,
          std::span<float> y);

/// C = alpha·A·B, C stored like A. Throws as gemv.
void gemm(float alpha, const ColumnMajor& a, const ColumnMajor& b, std::span<float> c);

}  // namespace relumbre
