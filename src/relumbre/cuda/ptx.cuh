/// Instructions that CUDA C++ has no word for: accesses with an order, at the scope of the device.
#pragma once

#include <cstdint>

#include <cuda_runtime.h>

namespace relumbre::cuda {

__device__ __forceinline__ std::uint32_t load_relaxed(const std::uint32_t* at) {
  std::uint32_t value;
  asm volatile("ld.relaxed.gpu.global.u32 %0, [%1];" : "=r"(value) : "l"(at) : "memory");
  return value;
}
__device__ __forceinline__ std::uint64_t load_relaxed(const std::uint64_t* at) {
  std::uint64_t value;
  asm volatile("ld.relaxed.gpu.global.u64 %0, [%1];" : "=l"(value) : "l"(at) : "memory");
  return value;
}
__device__ __forceinline__ void store_relaxed(std::uint32_t* at, std::uint32_t value) {
  asm volatile("st.relaxed.gpu.global.u32 [%0], %1;" ::"l"(at), "r"(value) : "memory");
}
__device__ __forceinline__ void store_relaxed(std::uint64_t* at, std::uint64_t value) {
  asm volatile("st.relaxed.gpu.global.u64 [%0], %1;" ::"l"(at), "l"(value) : "memory");
}

/// Makes the compiler take `value` for a new one. What it worked out from the old one it then works
/// out again instead of keeping it in registers. No instruction.
template <class T>
__device__ __forceinline__ void forget(T& value) {
  constexpr unsigned words = (sizeof(T) + 3) / 4;
  unsigned parts[words] = {};
  memcpy(parts, &value, sizeof(T));
#pragma unroll
  for (unsigned i = 0; i < words; ++i) asm volatile("" : "+r"(parts[i]));
  memcpy(&value, parts, sizeof(T));
}

/// d += a b on the tensor cores: a is 16 × 16 halves, b 16 × 8, d 16 × 8 floats, shared out among
/// the 32 lanes of a warp, which all call it. Lane 4g + t has, as pairs of neighbouring columns of
/// a and of neighbouring rows of b,
///
///   a[0], a[2]   row g        columns 2t, 2t + 1 and 8 more        b[0]   rows 2t, 2t + 1    } of
///   a[1], a[3]   row g + 8    columns 2t, 2t + 1 and 8 more        b[1]   8 more    } column g
///   d[0], d[1]   row g        columns 2t, 2t + 1
///   d[2], d[3]   row g + 8    columns 2t, 2t + 1
__device__ __forceinline__ void multiply_tiles(float (&d)[4], const unsigned (&a)[4],
                                               const unsigned (&b)[2]) {
#if __CUDA_ARCH__ >= 800
  asm("mma.sync.aligned.m16n8k16.row.col.f32.f16.f16.f32 {%0, %1, %2, %3}, {%4, %5, %6, %7}, "
      "{%8, %9}, {%0, %1, %2, %3};"
      : "+f"(d[0]), "+f"(d[1]), "+f"(d[2]), "+f"(d[3])
      : "r"(a[0]), "r"(a[1]), "r"(a[2]), "r"(a[3]), "r"(b[0]), "r"(b[1]));
#else
#pragma unroll
  for (int half = 0; half < 2; ++half)
    asm("mma.sync.aligned.m16n8k8.row.col.f32.f16.f16.f32 {%0, %1, %2, %3}, {%4, %5}, {%6}, "
        "{%0, %1, %2, %3};"
        : "+f"(d[0]), "+f"(d[1]), "+f"(d[2]), "+f"(d[3])
        : "r"(a[2 * half]), "r"(a[2 * half + 1]), "r"(b[half]));
#endif
}

}  // namespace relumbre::cuda
