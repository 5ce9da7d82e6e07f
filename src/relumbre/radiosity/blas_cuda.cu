#include <string>

#include "relumbre/cuda/error.h"
#include "relumbre/radiosity/blas_cuda.h"

namespace relumbre::cuda {

namespace {

void check(cublasStatus_t status) {
  if (status != CUBLAS_STATUS_SUCCESS)
    throw DeviceError(std::string("cuBLAS: ") + cublasGetStatusString(status));
}

cublasOperation_t operation(const BlasMatrix& m) {
  return m.transposed ? CUBLAS_OP_T : CUBLAS_OP_N;
}

}  // namespace

Blas::Blas() {
  cublasHandle_t handle = nullptr;
  check(cublasCreate(&handle));
  handle_.reset(handle);
  check(cublasSetMathMode(handle, CUBLAS_PEDANTIC_MATH));
}

void Blas::gemm(const Stream& stream, const BlasProduct& p) const {
  check(cublasSetStream(handle_.get(), stream.get()));
  check(cublasSgemm(handle_.get(), operation(p.a), operation(p.b), static_cast<int>(p.rows),
                    static_cast<int>(p.columns), static_cast<int>(p.inner), &p.alpha, p.a.values,
                    static_cast<int>(p.a.stride), p.b.values, static_cast<int>(p.b.stride), &p.beta,
                    p.c, static_cast<int>(p.c_stride)));
}

void Blas::gemv(const Stream& stream, std::size_t rows, std::size_t columns, const BlasMatrix& a,
                const float* x, float alpha, float beta, float* y) const {
  check(cublasSetStream(handle_.get(), stream.get()));
  check(cublasSgemv(handle_.get(), operation(a), static_cast<int>(rows), static_cast<int>(columns),
                    &alpha, a.values, static_cast<int>(a.stride), x, 1, &beta, y, 1));
}

}  // namespace relumbre::cuda
