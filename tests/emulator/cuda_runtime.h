/// The emulator's device side of CUDA: as much of the language as Relumbre's kernels use.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "cuda_runtime_api.h"

#define __forceinline__ inline __attribute__((always_inline))
#define __launch_bounds__(...)
#define __grid_constant__
#define __align__(n) alignas(n)

struct alignas(8) uint2 {
  unsigned x, y;
};
struct alignas(16) uint4 {
  unsigned x, y, z, w;
};
struct alignas(8) int2 {
  int x, y;
};
struct alignas(16) int4 {
  int x, y, z, w;
};
struct alignas(8) float2 {
  float x, y;
};
struct float3 {
  float x, y, z;
};
struct alignas(16) float4 {
  float x, y, z, w;
};
struct alignas(16) double2 {
  double x, y;
};
inline uint2 make_uint2(unsigned x, unsigned y) { return {x, y}; }
inline uint4 make_uint4(unsigned x, unsigned y, unsigned z, unsigned w) { return {x, y, z, w}; }
inline int2 make_int2(int x, int y) { return {x, y}; }
inline int4 make_int4(int x, int y, int z, int w) { return {x, y, z, w}; }
inline float2 make_float2(float x, float y) { return {x, y}; }
inline float3 make_float3(float x, float y, float z) { return {x, y, z}; }
inline float4 make_float4(float x, float y, float z, float w) { return {x, y, z, w}; }

using std::max;
using std::min;

// Barriers and exchanges. Every one knows where it stands in the source.
inline void __syncthreads(emulator::Site site = emulator::Site::current()) {
  emulator::barrier(site);
}
inline void __syncwarp(unsigned mask = ~0U, emulator::Site site = emulator::Site::current()) {
  emulator::exchange(mask, 0, site, [](const auto&) { return 0; });
}
inline void __threadfence() {}
inline void __threadfence_block() {}
inline void __nanosleep(unsigned) { emulator::yield(); }

template <class T>
T __shfl_sync(unsigned mask, T value, int from, int width = 32,
              emulator::Site site = emulator::Site::current()) {
  const unsigned lane = emulator::lane(), w = static_cast<unsigned>(width);
  return emulator::exchange(mask, value, site, [=](const emulator::Exchange& all) {
    return emulator::value_of<T>(all, lane / w * w + static_cast<unsigned>(from) % w);
  });
}
template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned by, int width = 32,
                 emulator::Site site = emulator::Site::current()) {
  const unsigned lane = emulator::lane(), in = lane % static_cast<unsigned>(width);
  return emulator::exchange(mask, value, site, [=](const emulator::Exchange& all) {
    return emulator::value_of<T>(all, in >= by ? lane - by : lane);
  });
}
template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned by, int width = 32,
                   emulator::Site site = emulator::Site::current()) {
  const unsigned lane = emulator::lane(), w = static_cast<unsigned>(width);
  return emulator::exchange(mask, value, site, [=](const emulator::Exchange& all) {
    return emulator::value_of<T>(all, lane % w + by < w ? lane + by : lane);
  });
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, int by, int width = 32,
                  emulator::Site site = emulator::Site::current()) {
  const unsigned lane = emulator::lane(), w = static_cast<unsigned>(width);
  const unsigned to = lane ^ static_cast<unsigned>(by);
  return emulator::exchange(mask, value, site, [=](const emulator::Exchange& all) {
    return emulator::value_of<T>(all, to / w <= lane / w ? to : lane);
  });
}
inline unsigned __ballot_sync(unsigned mask, int predicate,
                              emulator::Site site = emulator::Site::current()) {
  return emulator::exchange(mask, predicate, site, [=](const emulator::Exchange& all) {
    unsigned result = 0;
    for (unsigned i = 0; i < 32; ++i)
      if ((mask >> i & 1) != 0 && emulator::value_of<int>(all, i) != 0) result |= 1U << i;
    return result;
  });
}
inline int __any_sync(unsigned mask, int predicate,
                      emulator::Site site = emulator::Site::current()) {
  return __ballot_sync(mask, predicate, site) != 0;
}
inline int __all_sync(unsigned mask, int predicate,
                      emulator::Site site = emulator::Site::current()) {
  return __ballot_sync(mask, predicate, site) == mask;
}
template <class T>
unsigned __match_any_sync(unsigned mask, T value, emulator::Site site = emulator::Site::current()) {
  return emulator::exchange(mask, value, site, [=](const emulator::Exchange& all) {
    unsigned result = 0;
    for (unsigned i = 0; i < 32; ++i)
      if ((mask >> i & 1) != 0 && emulator::value_of<T>(all, i) == value) result |= 1U << i;
    return result;
  });
}

// Atomics: threads only give way at barriers, exchanges and yields.
template <class T>
T atomicAdd(T* at, T value) {
  const T old = *at;
  if constexpr (std::is_integral_v<T>)
    *at = static_cast<T>(static_cast<std::make_unsigned_t<T>>(old) +
                         static_cast<std::make_unsigned_t<T>>(value));
  else
    *at = old + value;
  return old;
}
template <class T>
T atomicMax(T* at, T value) {
  const T old = *at;
  return *at = std::max(old, value), old;
}
template <class T>
T atomicMin(T* at, T value) {
  const T old = *at;
  return *at = std::min(old, value), old;
}
template <class T>
T atomicOr(T* at, T value) {
  const T old = *at;
  return *at = old | value, old;
}
template <class T>
T atomicAnd(T* at, T value) {
  const T old = *at;
  return *at = old & value, old;
}
template <class T>
T atomicExch(T* at, T value) {
  const T old = *at;
  return *at = value, old;
}

template <class T>
T __ldg(const T* at) {
  return *at;
}
template <class T>
T __ldcg(const T* at) {
  return *at;
}
template <class T>
void __stcg(T* at, T value) {
  *at = value;
}

inline int __popc(unsigned x) { return std::popcount(x); }
inline int __popcll(unsigned long long x) { return std::popcount(x); }
inline int __clz(int x) { return std::countl_zero(static_cast<unsigned>(x)); }
inline int __clzll(long long x) { return std::countl_zero(static_cast<unsigned long long>(x)); }
inline int __ffs(int x) { return x == 0 ? 0 : std::countr_zero(static_cast<unsigned>(x)) + 1; }
inline int __ffsll(long long x) {
  return x == 0 ? 0 : std::countr_zero(static_cast<unsigned long long>(x)) + 1;
}
/// Bytes of y x, numbered 0 to 7, by the four nibbles of a selector.
inline unsigned __byte_perm(unsigned x, unsigned y, unsigned selector) {
  const std::uint64_t bytes = static_cast<std::uint64_t>(y) << 32 | x;
  unsigned result = 0;
  for (unsigned i = 0; i < 4; ++i)
    result |= static_cast<unsigned>(bytes >> 8 * (selector >> 4 * i & 7) & 0xFF) << 8 * i;
  return result;
}
inline float __uint_as_float(unsigned x) { return std::bit_cast<float>(x); }
inline unsigned __float_as_uint(float x) { return std::bit_cast<unsigned>(x); }
inline float __int_as_float(int x) { return std::bit_cast<float>(x); }
inline int __float_as_int(float x) { return std::bit_cast<int>(x); }
inline long long __double_as_longlong(double x) { return std::bit_cast<long long>(x); }
inline float __fmaf_rn(float a, float b, float c) { return std::fma(a, b, c); }
inline double __fma_rn(double a, double b, double c) { return std::fma(a, b, c); }
inline float __fadd_rn(float a, float b) { return a + b; }
inline float __fsub_rn(float a, float b) { return a - b; }
inline float __fmul_rn(float a, float b) { return a * b; }
inline float __fdiv_rn(float a, float b) { return a / b; }
inline double __dadd_rn(double a, double b) { return a + b; }
inline double __dsub_rn(double a, double b) { return a - b; }
inline double __dmul_rn(double a, double b) { return a * b; }
inline float __fsqrt_rn(float a) { return std::sqrt(a); }
inline int __float2int_rn(float a) { return static_cast<int>(std::nearbyint(a)); }
inline long long __double2ll_rn(double a) { return static_cast<long long>(std::nearbyint(a)); }
