/// The products of dense matrices that cuBLAS does.
#pragma once

#include <cstddef>
#include <memory>
#include <source_location>

#include <cublas_v2.h>

#include "relumbre/cuda/stream.h"

namespace relumbre::cuda {

/// A matrix of columns one after the other, `stride` apart; the product takes it or its transpose.
struct BlasMatrix {
  const float* values;
  std::size_t stride;
  bool transposed = false;
};

/// c = alpha · a b + beta · c: rows × inner times inner × columns. Float32 throughout.
struct BlasProduct {
  std::size_t rows, columns, inner;
  BlasMatrix a, b;
  float alpha = 1, beta = 0;
  float* c;
  std::size_t c_stride;
};

/// A handle of cuBLAS. Sizes must fit ints. Functions throw DeviceError.
class Blas {
 public:
  Blas();
  void gemm(const Stream& stream, const BlasProduct& product) const;
  /// y = alpha · op(a) x + beta · y, where a is rows × columns.
  void gemv(const Stream& stream, std::size_t rows, std::size_t columns, const BlasMatrix& a,
            const float* x, float alpha, float beta, float* y) const;

 private:
  struct Destroy {
    void operator()(cublasHandle_t handle) const { cublasDestroy(handle); }
  };
  std::unique_ptr<cublasContext, Destroy> handle_;
};

}  // namespace relumbre::cuda
