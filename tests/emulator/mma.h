/// The emulator's tensor cores: 16 × 16 × 16 products of halves, summed in float. Every lane holds
/// whole tiles and does the whole product, which is slow and right.
#pragma once

#include <cstddef>

#include "cuda_fp16.h"
#include "cuda_runtime.h"

namespace nvcuda::wmma {

struct matrix_a {};
struct matrix_b {};
struct accumulator {};
struct row_major {};
struct col_major {};
enum layout_t { mem_row_major, mem_col_major };

template <class Use, int kM, int kN, int kK, class T, class Layout = void>
struct fragment {
  static_assert(kM == 16 && kN == 16 && kK == 16);
  static constexpr int num_elements = 256;
  T x[256];  ///< row by row
};

template <class Fragment, class T>
void fill_fragment(Fragment& f, T value) {
  for (auto& x : f.x) x = value;
}

template <class Use, class T, class Layout>
void load_matrix_sync(fragment<Use, 16, 16, 16, T, Layout>& f, const T* from, unsigned stride) {
  __syncwarp();
  for (unsigned i = 0; i < 16; ++i)
    for (unsigned j = 0; j < 16; ++j)
      f.x[16 * i + j] =
          std::is_same_v<Layout, row_major> ? from[i * stride + j] : from[j * stride + i];
}

template <class LayoutA, class LayoutB>
void mma_sync(fragment<accumulator, 16, 16, 16, float>& d,
              const fragment<matrix_a, 16, 16, 16, __half, LayoutA>& a,
              const fragment<matrix_b, 16, 16, 16, __half, LayoutB>& b,
              const fragment<accumulator, 16, 16, 16, float>& c) {
  for (unsigned i = 0; i < 16; ++i) {
    for (unsigned j = 0; j < 16; ++j) {
      float sum = c.x[16 * i + j];
      for (unsigned k = 0; k < 16; ++k)
        sum += __half2float(a.x[16 * i + k]) * __half2float(b.x[16 * k + j]);
      d.x[16 * i + j] = sum;
    }
  }
}

inline void store_matrix_sync(float* to, const fragment<accumulator, 16, 16, 16, float>& f,
                              unsigned stride, layout_t layout) {
  __syncwarp();
  const unsigned lane = emulator::lane();
  for (unsigned e = lane; e < 256; e += 32) {
    const unsigned i = e / 16, j = e % 16;
    to[layout == mem_row_major ? i * stride + j : j * stride + i] = f.x[e];
  }
}

}  // namespace nvcuda::wmma
