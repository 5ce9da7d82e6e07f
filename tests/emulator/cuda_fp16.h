/// The emulator's half-precision numbers.
#pragma once

#include <cstdint>

#include "cuda_runtime.h"

struct __half {
  _Float16 value;
};
struct alignas(4) __half2 {
  __half x, y;
};
using half = __half;
using half2 = __half2;

inline __half __float2half_rn(float x) { return {static_cast<_Float16>(x)}; }
inline __half __float2half(float x) { return __float2half_rn(x); }
inline float __half2float(__half x) { return static_cast<float>(x.value); }
inline __half2 __halves2half2(__half x, __half y) { return {x, y}; }
inline __half2 __hsub2(__half2 a, __half2 b) {
  return {{static_cast<_Float16>(a.x.value - b.x.value)},
          {static_cast<_Float16>(a.y.value - b.y.value)}};
}
inline __half2 __hmul2(__half2 a, __half2 b) {
  return {{static_cast<_Float16>(a.x.value * b.x.value)},
          {static_cast<_Float16>(a.y.value * b.y.value)}};
}
inline __half __low2half(__half2 x) { return x.x; }
