/// The emulator's cuBLAS: the few products that Relumbre asks for, in plain loops.
#pragma once

#include <cstddef>

#include "cuda_runtime_api.h"

enum cublasStatus_t { CUBLAS_STATUS_SUCCESS, CUBLAS_STATUS_NOT_INITIALIZED };
enum cublasOperation_t { CUBLAS_OP_N, CUBLAS_OP_T };
enum cublasMath_t { CUBLAS_DEFAULT_MATH, CUBLAS_PEDANTIC_MATH };
struct cublasContext {
  cudaStream_t stream = nullptr;
};
using cublasHandle_t = cublasContext*;

inline const char* cublasGetStatusString(cublasStatus_t) { return "refused by the emulator"; }
inline cublasStatus_t cublasCreate(cublasHandle_t* handle) {
  return *handle = new cublasContext, CUBLAS_STATUS_SUCCESS;
}
inline cublasStatus_t cublasDestroy(cublasHandle_t handle) {
  return delete handle, CUBLAS_STATUS_SUCCESS;
}
inline cublasStatus_t cublasSetStream(cublasHandle_t handle, cudaStream_t stream) {
  return handle->stream = stream, CUBLAS_STATUS_SUCCESS;
}
inline cublasStatus_t cublasSetMathMode(cublasHandle_t, cublasMath_t) {
  return CUBLAS_STATUS_SUCCESS;
}

/// c = alpha · op(a) op(b) + beta · c, columns contiguous.
inline cublasStatus_t cublasSgemm(cublasHandle_t handle, cublasOperation_t op_a,
                                  cublasOperation_t op_b, int m, int n, int k, const float* alpha,
                                  const float* a, int lda, const float* b, int ldb,
                                  const float* beta, float* c, int ldc) {
  emulator::enqueue(handle->stream, [=, alpha = *alpha, beta = *beta] {
    const auto at = [](int row, int column, int stride) {
      return static_cast<std::size_t>(column) * static_cast<std::size_t>(stride) +
             static_cast<std::size_t>(row);
    };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < m; ++i) {
        double sum = 0;
        for (int p = 0; p < k; ++p)
          sum += static_cast<double>(a[op_a == CUBLAS_OP_N ? at(i, p, lda) : at(p, i, lda)]) *
                 static_cast<double>(b[op_b == CUBLAS_OP_N ? at(p, j, ldb) : at(j, p, ldb)]);
        float& out = c[at(i, j, ldc)];
        out = alpha * static_cast<float>(sum) + (beta == 0 ? 0 : beta * out);
      }
    }
  });
  return CUBLAS_STATUS_SUCCESS;
}

/// y = alpha · op(a) x + beta · y; a is m × n, columns contiguous.
inline cublasStatus_t cublasSgemv(cublasHandle_t handle, cublasOperation_t op, int m, int n,
                                  const float* alpha, const float* a, int lda, const float* x,
                                  int incx, const float* beta, float* y, int incy) {
  emulator::enqueue(handle->stream, [=, alpha = *alpha, beta = *beta] {
    const int rows = op == CUBLAS_OP_N ? m : n, columns = op == CUBLAS_OP_N ? n : m;
    for (int i = 0; i < rows; ++i) {
      double sum = 0;
      for (int j = 0; j < columns; ++j) {
        const int row = op == CUBLAS_OP_N ? i : j, column = op == CUBLAS_OP_N ? j : i;
        sum +=
            static_cast<double>(a[static_cast<std::size_t>(column) * static_cast<std::size_t>(lda) +
                                  static_cast<std::size_t>(row)]) *
            static_cast<double>(x[static_cast<std::ptrdiff_t>(j) * incx]);
      }
      float& out = y[static_cast<std::ptrdiff_t>(i) * incy];
      out = alpha * static_cast<float>(sum) + (beta == 0 ? 0 : beta * out);
    }
  });
  return CUBLAS_STATUS_SUCCESS;
}
