/// Arithmetic that CPU and GPU do in the same way, bit by bit. Code that runs on both sides is
/// written with these where the compilers differ: in fusing products with sums, above all.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "relumbre/base/host_device.h"

namespace relumbre {

/// a · b + c, rounded once.
RELUMBRE_HOST_DEVICE inline float fused(float a, float b, float c) { return ::fmaf(a, b, c); }

/// The larger and the smaller; b where one is no number.
RELUMBRE_HOST_DEVICE inline float larger(float a, float b) { return a > b ? a : b; }
RELUMBRE_HOST_DEVICE inline float smaller(float a, float b) { return a < b ? a : b; }

/// a · b - c · d to within 1.5 ulp: never of the wrong sign, and zero only where it is zero, unless
/// a product leaves the range of normal numbers. Source: Jeannerod, Louvet and Muller 2013
/// (Kahan's method).
RELUMBRE_HOST_DEVICE inline float difference_of_products(float a, float b, float c, float d) {
  const float second = c * d;
  const float lost = fused(-c, d, second);
  return fused(a, b, -second) + lost;
}

RELUMBRE_HOST_DEVICE inline float float_of_bits(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return __uint_as_float(bits);
#else
  float value;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
#endif
}

RELUMBRE_HOST_DEVICE inline std::uint32_t bits_of_float(float value) {
#if defined(__CUDA_ARCH__)
  return __float_as_uint(value);
#else
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return bits;
#endif
}

RELUMBRE_HOST_DEVICE inline std::uint32_t bit_count(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return static_cast<std::uint32_t>(__popc(bits));
#else
  return static_cast<std::uint32_t>(__builtin_popcount(bits));
#endif
}

/// Number of the highest bit that is set; `bits` must not be 0.
RELUMBRE_HOST_DEVICE inline std::uint32_t highest_bit(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return 31U - static_cast<std::uint32_t>(__clz(static_cast<int>(bits)));
#else
  return 31U - static_cast<std::uint32_t>(__builtin_clz(bits));
#endif
}

/// Number of the lowest bit that is set; `bits` must not be 0.
RELUMBRE_HOST_DEVICE inline std::uint32_t lowest_bit(std::uint32_t bits) {
  return highest_bit(bits & (0U - bits));
}

/// Sixteen bytes that are loaded at once.
struct alignas(16) Words4 {
  std::uint32_t x, y, z, w;
};

/// `from` must be aligned to 16 bytes, and nothing may write there while a kernel runs.
RELUMBRE_HOST_DEVICE inline Words4 load_words(const void* from) {
#if defined(__CUDA_ARCH__)
  const uint4 words = __ldg(static_cast<const uint4*>(from));
  return {words.x, words.y, words.z, words.w};
#else
  Words4 words;
  std::memcpy(&words, from, sizeof(words));
  return words;
#endif
}

}  // namespace relumbre
