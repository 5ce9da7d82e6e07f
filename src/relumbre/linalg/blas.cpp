#include "relumbre/linalg/blas.h"

#include <limits>

#include <cblas.h>
#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

int side(std::size_t length) {
  if (length > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw ValueError(fmt::format("a matrix side of {} exceeds what BLAS addresses", length));
  return static_cast<int>(length);
}

void check_shape(bool agrees, const char* operation, const ColumnMajor& a) {
  if (!agrees || a.values.size() != a.rows * a.columns)
    throw ShapeError(fmt::format("{}: operands do not fit a {} x {} matrix of {} values", operation,
                                 a.rows, a.columns, a.values.size()));
}

}  // namespace

void gemv(Transpose op, float alpha, const ColumnMajor& a, std::span<const float> x, float beta,
          std::span<float> y) {
  const bool transposed = op == Transpose::kYes;
  check_shape(x.size() == (transposed ? a.rows : a.columns) &&
                  y.size() == (transposed ? a.columns : a.rows),
              "gemv", a);
  cblas_sgemv(CblasColMajor, transposed ? CblasTrans : CblasNoTrans, side(a.rows), side(a.columns),
              alpha, a.values.data(), side(a.rows), x.data(), 1, beta, y.data(), 1);
}

void gemm(float alpha, const ColumnMajor& a, const ColumnMajor& b, std::span<float> c) {
  check_shape(a.columns == b.rows && c.size() == a.rows * b.columns, "gemm", a);
  check_shape(true, "gemm", b);
  cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, side(a.rows), side(b.columns),
              side(a.columns), alpha, a.values.data(), side(a.rows), b.values.data(), side(b.rows),
              0.0F, c.data(), side(a.rows));
}

}  // namespace relumbre
