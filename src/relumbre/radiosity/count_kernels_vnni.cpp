// U·y with vpdpbusd: 64 counts of 8 bits times 64 digits of 8 bits an instruction.
//
// Each channel of y is scaled to 24-bit fixed point and written in balanced base 256,
//
//   y_cp ≈ s_c · (d2·65536 + d1·256 + d0),   -128 ≤ d ≤ 127
//
// so that C·y is three integer dot products a channel, exact but for the rounding of y to 2^-24 of
// its largest entry. They cannot overflow: |Σ c·d| ≤ columns · 255 · 128 < 2^31 for
// columns ≤ kMaxVnniColumns.
//
//   operand   s_0 s_1 s_2 0 ...                                   64 bytes
//             block 0 of 64 columns: channel 0: d0 ×64 | d1 ×64 | d2 ×64
//                                    channel 1: ...
//             block 1: ...
#include "relumbre/radiosity/count_kernels_vnni.h"

#if defined(__x86_64__)

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <immintrin.h>

// GCC's AVX-512 headers start from registers that they leave undefined on purpose (GCC bug 105593).
#if !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace relumbre {

namespace {

constexpr std::size_t kBlock = 64;
constexpr std::size_t kChannels = 3;
constexpr std::size_t kDigits = 3;
constexpr std::size_t kSums = kChannels * kDigits;
constexpr std::size_t kBlockBytes = kSums * kBlock;
constexpr std::size_t kLanes = 16;
/// Three digits reach 127·65793; the rest is room for rounding up.
constexpr float kLargest = 127 * 65536;

std::size_t block_count(std::size_t columns) { return (columns + kBlock - 1) / kBlock; }

std::size_t operand_bytes(std::size_t columns) {
  return kOperandAlignment + block_count(columns) * kBlockBytes;
}

/// Writes the digits of 16 values, 64 bytes apart.
[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] inline void write_digits(
    __m512 values, std::byte* digits) {
  const __m512i half = _mm512_set1_epi32(128);
  __m512i rest = _mm512_cvtps_epi32(values);
  for (std::size_t d = 0; d < kDigits; ++d) {
    _mm_store_si128(reinterpret_cast<__m128i*>(digits + d * kBlock),
                    _mm512_cvtepi32_epi8(rest));  // the low byte, read as signed
    rest = _mm512_srai_epi32(_mm512_add_epi32(rest, half), 8);
  }
}

[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] inline float largest_magnitude(
    const float* y, std::size_t columns) {
  __m512 largest = _mm512_setzero_ps();
  for (std::size_t p = 0; p < columns; p += kLanes) {
    const std::size_t left = std::min(kLanes, columns - p);
    const auto mask = static_cast<__mmask16>((1U << left) - 1);
    largest = _mm512_max_ps(largest, _mm512_abs_ps(_mm512_maskz_loadu_ps(mask, y + p)));
  }
  return _mm512_reduce_max_ps(largest);
}

[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] void pack(const float* y,
                                                                           std::size_t columns,
                                                                           std::byte* operand) {
  std::memset(operand, 0, kOperandAlignment);
  for (std::size_t c = 0; c < kChannels; ++c) {
    const float largest = largest_magnitude(y + c * columns, columns);
    const float scale = largest / kLargest;
    const __m512 inverse = _mm512_set1_ps(scale > 0 ? kLargest / largest : 0.0F);
    std::memcpy(operand + c * sizeof(float), &scale, sizeof scale);
    std::byte* block = operand + kOperandAlignment + c * kDigits * kBlock;
    for (std::size_t p = 0; p < block_count(columns) * kBlock; p += kLanes) {
      const std::size_t left = p < columns ? std::min(kLanes, columns - p) : 0;
      const auto mask = static_cast<__mmask16>((1U << left) - 1);
      const __m512 values = _mm512_maskz_loadu_ps(mask, y + c * columns + p);
      write_digits(_mm512_mul_ps(values, inverse), block + p / kBlock * kBlockBytes + p % kBlock);
    }
  }
}

/// sum += counts · digits, four at a time. As an instruction and not an intrinsic, because GCC 12
/// copies every accumulator through a second register, and some through memory, around the latter.
[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] inline __m512i add_products(
    __m512i sum, __m512i counts, __m512i digits) {
  asm("vpdpbusd %2, %1, %0" : "+v"(sum) : "v"(counts), "v"(digits));
  return sum;
}

/// d2·65536 + d1·256 + d0
[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] inline __m512 from_digits(
    __m512i d0, __m512i d1, __m512i d2) {
  const __m512 base = _mm512_set1_ps(256.0F);
  const __m512 high = _mm512_fmadd_ps(_mm512_cvtepi32_ps(d2), base, _mm512_cvtepi32_ps(d1));
  return _mm512_fmadd_ps(high, base, _mm512_cvtepi32_ps(d0));
}

/// Adds kRows rows' products into 16 partial sums a row and channel.
template <std::size_t kRows>
[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] inline void multiply_rows(
    const std::uint8_t* table, std::size_t columns, const std::byte* operand, float* partial) {
  __m512i sum[kRows * kSums];
#pragma GCC unroll 18
  for (std::size_t s = 0; s < kRows * kSums; ++s) sum[s] = _mm512_setzero_si512();
  const std::byte* digits = operand + kOperandAlignment;
  const std::size_t ahead = prefetch_distance(kRows * columns);
  for (std::size_t p = 0; p < columns; p += kBlock, digits += kBlockBytes) {
    __m512i counts[kRows];
#pragma GCC unroll 2
    for (std::size_t r = 0; r < kRows; ++r) {
      const std::uint8_t* at = table + r * columns + p;
      counts[r] = _mm512_loadu_si512(at);
      prefetch_table(at, ahead);
    }
#pragma GCC unroll 9
    for (std::size_t s = 0; s < kSums; ++s) {
      const __m512i d = _mm512_load_si512(digits + s * kBlock);
#pragma GCC unroll 2
      for (std::size_t r = 0; r < kRows; ++r)
        sum[r * kSums + s] = add_products(sum[r * kSums + s], counts[r], d);
    }
  }
  float scales[kLanes];
  std::memcpy(scales, operand, sizeof scales);
#pragma GCC unroll 6
  for (std::size_t v = 0; v < kRows * kChannels; ++v) {
    const __m512 total = from_digits(sum[v * kDigits], sum[v * kDigits + 1], sum[v * kDigits + 2]);
    _mm512_store_ps(partial + v * kLanes,
                    _mm512_mul_ps(total, _mm512_set1_ps(scales[v % kChannels])));
  }
}

/// Lane i of the result is the sum of the 16 lanes of vector i: a transpose that adds on the way.
[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] inline __m512 sum_16_vectors(
    const float* vectors) {
  __m512 pair[8], quad[4];
  for (std::size_t i = 0; i < 8; ++i) {  // lanes a b a b in each quarter
    const __m512 a = _mm512_load_ps(vectors + 2 * i * kLanes);
    const __m512 b = _mm512_load_ps(vectors + (2 * i + 1) * kLanes);
    pair[i] = _mm512_add_ps(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
  }
  for (std::size_t i = 0; i < 4; ++i) {  // lanes a b c d in each quarter
    const __m512d ab = _mm512_castps_pd(pair[2 * i]), cd = _mm512_castps_pd(pair[2 * i + 1]);
    quad[i] = _mm512_add_ps(_mm512_castpd_ps(_mm512_unpacklo_pd(ab, cd)),
                            _mm512_castpd_ps(_mm512_unpackhi_pd(ab, cd)));
  }
  const __m512 low = _mm512_add_ps(_mm512_shuffle_f32x4(quad[0], quad[1], 0x88),
                                   _mm512_shuffle_f32x4(quad[0], quad[1], 0xDD));
  const __m512 high = _mm512_add_ps(_mm512_shuffle_f32x4(quad[2], quad[3], 0x88),
                                    _mm512_shuffle_f32x4(quad[2], quad[3], 0xDD));
  return _mm512_add_ps(_mm512_shuffle_f32x4(low, high, 0x88),
                       _mm512_shuffle_f32x4(low, high, 0xDD));
}

/// Two rows at a time: 18 sums, so that each load of digits serves two products.
[[gnu::target("avx512f,avx512bw,avx512vl,avx512dq,avx512vnni")]] void multiply(
    const void* table, std::size_t rows, std::size_t columns, const std::byte* operand,
    float* out) {
  constexpr std::size_t kGroup = 16;  // rows whose 48 sums fill three vectors
  const auto* first = static_cast<const std::uint8_t*>(table);
  alignas(64) float partial[kGroup * kChannels * kLanes];
  for (std::size_t g = 0; g < rows; g += kGroup) {
    const std::size_t here = std::min(kGroup, rows - g);
    std::size_t r = 0;
    for (; r + 2 <= here; r += 2)
      multiply_rows<2>(first + (g + r) * columns, columns, operand,
                       partial + r * kChannels * kLanes);
    if (r < here)
      multiply_rows<1>(first + (g + r) * columns, columns, operand,
                       partial + r * kChannels * kLanes);
    const std::size_t sums = here * kChannels;
    std::fill(partial + sums * kLanes, std::end(partial), 0.0F);
    for (std::size_t s = 0; s < sums; s += kLanes) {
      const auto mask = static_cast<__mmask16>((1U << std::min(kLanes, sums - s)) - 1);
      _mm512_mask_storeu_ps(out + g * kChannels + s, mask, sum_16_vectors(partial + s * kLanes));
    }
  }
}

}  // namespace

bool has_vnni() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vnni");
}

RowProduct vnni_uint8_product() { return {operand_bytes, pack, multiply}; }

}  // namespace relumbre

#else

namespace relumbre {

bool has_vnni() { return false; }

RowProduct vnni_uint8_product() { return {}; }

}  // namespace relumbre

#endif
