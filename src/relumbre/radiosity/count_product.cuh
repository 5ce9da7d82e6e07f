/// U y on the tensor cores: rows of ray counts times a few vectors, in one pass over the counts.
///
/// A warp takes 16 rows. Lane 4g + t reads 16 bytes at a time of rows g and g + 8, neighbours t
/// beside each other; so the columns come in an order of the lanes' own, which does no harm, since
/// the vectors are read in the same order. Counts become halves without loss (a byte of 16 bits at
/// a time), vectors are given as two halves each, high and low, whose products are summed apart:
///
///   column 2q of the right side: the high halves of vector q, column 2q + 1: 2048 times the low
///
/// The tensor cores' sums are cut off, not rounded; after 256 columns they go to float sums proper.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <cuda_fp16.h>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/ptx.cuh"
#include "relumbre/radiosity/count_table_cuda.h"

namespace relumbre::cuda {

inline constexpr unsigned kProductThreads = 256;
inline constexpr unsigned kTileRows = 16;
/// Of a row, read by four lanes side by side. Rows are padded to whole steps.
inline constexpr unsigned kStepBytes = 64;
inline constexpr float kLowScale = 2048;

/// Bytes are put below 0x64: the half 1024 + b.
__device__ __forceinline__ unsigned halves_of_bytes(unsigned word, unsigned selector) {
  const unsigned biased = __byte_perm(word, 0x64646464U, selector), bias = 0x64006400U;
  __half2 a, b;
  memcpy(&a, &biased, 4);
  memcpy(&b, &bias, 4);
  const __half2 exact = __hsub2(a, b);
  unsigned result;
  memcpy(&result, &exact, 4);
  return result;
}
__device__ __forceinline__ unsigned times_256(unsigned halves) {
  const unsigned factor = 0x5C005C00U;
  __half2 a, b;
  memcpy(&a, &halves, 4);
  memcpy(&b, &factor, 4);
  const __half2 product = __hmul2(a, b);
  unsigned result;
  memcpy(&result, &product, 4);
  return result;
}

// How a table's entries become halves. Of 16 bytes of a row a lane has kColumns columns; product
// `j` of a step takes four of them, as pairs 0 and 1, in kParts parts that add up.

struct Table8 {
  static constexpr unsigned kEntryBytes = 1, kParts = 1, kColumns = 16, kPitchPad = 16;
  __device__ static void pairs(const unsigned (&words)[4], unsigned j, unsigned,
                               unsigned (&pair)[2]) {
    pair[0] = halves_of_bytes(words[j], 0x4140);
    pair[1] = halves_of_bytes(words[j], 0x4342);
  }
};
struct Table16 {
  static constexpr unsigned kEntryBytes = 2, kParts = 2, kColumns = 8, kPitchPad = 64;
  __device__ static void pairs(const unsigned (&words)[4], unsigned j, unsigned part,
                               unsigned (&pair)[2]) {
#pragma unroll
    for (unsigned i = 0; i < 2; ++i) {
      const unsigned word = words[2 * j + i];
      pair[i] =
          part == 0 ? halves_of_bytes(word, 0x4240) : times_256(halves_of_bytes(word, 0x4341));
    }
  }
};
struct TableHalf {
  static constexpr unsigned kEntryBytes = 2, kParts = 1, kColumns = 8, kPitchPad = 64;
  __device__ static void pairs(const unsigned (&words)[4], unsigned j, unsigned,
                               unsigned (&pair)[2]) {
    pair[0] = words[2 * j];
    pair[1] = words[2 * j + 1];
  }
};

struct CountProduct {
  const unsigned char* table;  ///< rows of row_bytes, a multiple of kStepBytes; padding is 0
  std::size_t row_bytes;
  unsigned first_tile, tiles;  ///< of 16 rows: which are wanted
  unsigned rows;               ///< of the table
  const __half* operand;       ///< 8 · kTiles vectors of padded columns, high and low by turns
  const float* unscale;        ///< 4 · kTiles; what each vector was divided by
  unsigned chunk;              ///< columns of the operand that shared memory holds at a time
  const ExcessCount* excess;   ///< by row
  const std::uint32_t* excess_offsets;  ///< of each tile of 16 rows, one more at the end
  const float* vectors;                 ///< the vectors themselves: `count` of `columns`
  unsigned count, columns;
};

/// Bytes between the vectors of the operand in shared memory: such that the lanes of a quarter of a
/// warp, two vectors and four places, use all banks.
template <class Table>
__host__ __device__ constexpr std::size_t operand_pitch(unsigned chunk) {
  return std::size_t{chunk} * 2 + Table::kPitchPad;
}

template <class Table, unsigned kTiles>
class CountProductWork {
 public:
  __device__ CountProductWork(const CountProduct& p, unsigned char* shared)
      : p_(p),
        shared_(shared),
        padded_(static_cast<unsigned>(p.row_bytes / Table::kEntryBytes)),
        lane_(threadIdx.x % 32) {}

  template <class Store>
  __device__ void run(const Store& store) {
    const bool whole = p_.chunk >= padded_;
    if (whole) stage(0);
    constexpr unsigned warps = kProductThreads / 32;
    const unsigned end = p_.first_tile + p_.tiles;
    for (unsigned first = p_.first_tile + blockIdx.x * warps; first < end;
         first += gridDim.x * warps) {
      const unsigned tile = first + threadIdx.x / 32;
      float sum[kTiles][4] = {};
      for (unsigned column = 0; column < padded_; column += p_.chunk) {
        if (!whole) {
          __syncthreads();
          stage(column);
        }
        if (tile < end) multiply(tile, column, sum);
      }
      if (tile < end) finish(tile, sum, store);
    }
  }

 private:
  static constexpr unsigned kStepColumns = kStepBytes / Table::kEntryBytes;
  static constexpr unsigned kUnroll = kTiles == 1 ? 4 : kTiles == 3 ? 2 : 1;

  /// The operand's columns from `first` on, into shared memory.
  __device__ void stage(unsigned first) {
    const unsigned columns = std::min(p_.chunk, padded_ - first), quads = columns / 8;
    for (unsigned i = threadIdx.x; i < 8 * kTiles * quads; i += kProductThreads) {
      const unsigned vector = i / quads, quad = i % quads;
      const auto* from =
          reinterpret_cast<const uint4*>(p_.operand + std::size_t{vector} * padded_ + first) + quad;
      auto* to = reinterpret_cast<uint4*>(shared_ + vector * operand_pitch<Table>(p_.chunk)) + quad;
      *to = __ldg(from);
    }
    __syncthreads();
  }

  [[nodiscard]] __device__ const unsigned char* row(unsigned i, unsigned column) const {
    return p_.table + std::min(i, p_.rows - 1) * p_.row_bytes + column * Table::kEntryBytes +
           16 * (lane_ % 4);
  }

  __device__ void multiply(unsigned tile, unsigned column, float (&sum)[kTiles][4]) const {
    const unsigned columns = std::min(p_.chunk, padded_ - column), steps = columns / kStepColumns;
    const auto* top = reinterpret_cast<const uint4*>(row(tile * kTileRows + lane_ / 4, column));
    const auto* bottom =
        reinterpret_cast<const uint4*>(row(tile * kTileRows + 8 + lane_ / 4, column));
    for (unsigned step = 0; step < steps; step += kUnroll) {
      uint4 rows[kUnroll][2] = {};
#pragma unroll
      for (unsigned u = 0; u < kUnroll; ++u) {
        if (step + u < steps) {
          rows[u][0] = __ldg(top + (step + u) * (kStepBytes / 16));
          rows[u][1] = __ldg(bottom + (step + u) * (kStepBytes / 16));
        }
      }
      float part[kTiles][4] = {};
#pragma unroll
      for (unsigned u = 0; u < kUnroll; ++u)
        if (step + u < steps) multiply_step(rows[u], step + u, part);
#pragma unroll
      for (unsigned i = 0; i < kTiles; ++i)
#pragma unroll
        for (unsigned e = 0; e < 4; ++e) sum[i][e] += part[i][e];
    }
  }

  __device__ void multiply_step(const uint4 (&rows)[2], unsigned step,
                                float (&part)[kTiles][4]) const {
    const unsigned top[4] = {rows[0].x, rows[0].y, rows[0].z, rows[0].w};
    const unsigned bottom[4] = {rows[1].x, rows[1].y, rows[1].z, rows[1].w};
    unsigned a[Table::kColumns / 4][Table::kParts][4];
#pragma unroll
    for (unsigned j = 0; j < Table::kColumns / 4; ++j) {
#pragma unroll
      for (unsigned s = 0; s < Table::kParts; ++s) {
        unsigned upper[2], lower[2];
        Table::pairs(top, j, s, upper);
        Table::pairs(bottom, j, s, lower);
        a[j][s][0] = upper[0], a[j][s][1] = lower[0], a[j][s][2] = upper[1], a[j][s][3] = lower[1];
      }
    }
#pragma unroll
    for (unsigned i = 0; i < kTiles; ++i) {
      const unsigned char* vector = shared_ + (8 * i + lane_ / 4) * operand_pitch<Table>(p_.chunk);
      const auto* at = reinterpret_cast<const uint4*>(
          vector + 2 * (step * kStepColumns + (lane_ % 4) * Table::kColumns));
      unsigned words[Table::kColumns / 2];
#pragma unroll
      for (unsigned q = 0; q < Table::kColumns / 8; ++q) {
        const uint4 four = at[q];
        words[4 * q] = four.x, words[4 * q + 1] = four.y;
        words[4 * q + 2] = four.z, words[4 * q + 3] = four.w;
      }
#pragma unroll
      for (unsigned j = 0; j < Table::kColumns / 4; ++j) {
        const unsigned b[2] = {words[2 * j], words[2 * j + 1]};
#pragma unroll
        for (unsigned s = 0; s < Table::kParts; ++s) multiply_tiles(part[i], a[j][s], b);
      }
    }
  }

  /// store(row, vector, value) of what this lane has: vector 4i + t of rows g and g + 8.
  template <class Store>
  __device__ void finish(unsigned tile, const float (&sum)[kTiles][4], const Store& store) const {
#pragma unroll
    for (unsigned i = 0; i < kTiles; ++i) {
      const unsigned vector = 4 * i + lane_ % 4;
      if (vector >= p_.count) continue;
      const float unscale = p_.unscale[vector];
#pragma unroll
      for (unsigned half = 0; half < 2; ++half) {
        const unsigned row = tile * kTileRows + 8 * half + lane_ / 4;
        if (row >= p_.rows) continue;
        const float value = (sum[i][2 * half] + sum[i][2 * half + 1] * (1 / kLowScale)) * unscale;
        store(row, vector, value + beyond(tile, row, vector));
      }
    }
  }

  [[nodiscard]] __device__ float beyond(unsigned tile, unsigned row, unsigned vector) const {
    float sum = 0;
    const std::uint32_t end = p_.excess_offsets[tile + 1];
    for (std::uint32_t e = p_.excess_offsets[tile]; e < end; ++e) {
      const ExcessCount x = p_.excess[e];
      if (x.row == row) sum += x.count * p_.vectors[std::size_t{vector} * p_.columns + x.column];
    }
    return sum;
  }

  const CountProduct& p_;
  unsigned char* shared_;
  unsigned padded_, lane_;
};

/// store(row, vector, Σ_p table[row][p] · vector[p]) for all rows of the tiles.
template <class Table, unsigned kTiles, class Store>
__global__ void __launch_bounds__(kProductThreads)
    multiply_counts(CountProduct product, Store store) {
  CountProductWork<Table, kTiles>(product, &shared_as<unsigned char>()).run(store);
}

/// The operand of `count` vectors of `columns`: one block a vector, 4 · kTiles blocks. Each is
/// scaled by a power of two so that its largest value is below 2^14.
__global__ void split_vectors(const float* vectors, unsigned count, unsigned columns,
                              unsigned padded, __half* operand, float* unscale);

}  // namespace relumbre::cuda
