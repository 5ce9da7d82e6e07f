/// Device-only: sums in a tile's shared memory that do not depend on the order of their terms.
#pragma once

#include <cstdint>

#include <cuda_runtime.h>

#include "relumbre/cuda/warp.cuh"

namespace relumbre::cuda {

/// A number times 2^kFractionBits, as two's complement: sums wrap around and are right as long as
/// the result has fewer than 17 bits before the point.
using Fixed = unsigned long long;
inline constexpr int kFractionBits = 47;

/// Of |value| < 16. Beside 1.5 · 2^5 a double's last bit is worth 2^−47.
__device__ __forceinline__ Fixed fixed_of(double value) {
  constexpr double kBeside = 1.5 * (1 << (52 - kFractionBits));
  return static_cast<Fixed>(__double_as_longlong(value + kBeside)) -
         static_cast<Fixed>(__double_as_longlong(kBeside));
}
__device__ __forceinline__ double double_of(Fixed value) {
  constexpr double kUnit = 1.0 / (1ULL << kFractionBits);
  return static_cast<double>(static_cast<long long>(value)) * kUnit;
}

struct FixedSum {
  __device__ Fixed operator()(Fixed a, Fixed b) const { return a + b; }
};
__device__ __forceinline__ Fixed warp_total(Fixed value) {
#pragma unroll
  for (int by = 16; by > 0; by /= 2) value += __shfl_xor_sync(kAllLanes, value, by);
  return value;
}

inline constexpr int kTileColumns = 64;

/// Planes of sums, in halves: shared memory adds 32 bits in one instruction, 64 in a loop.
template <int kPlanes, int kRows>
struct FixedPlanes {
  static constexpr int kSums = kPlanes * kRows * kTileColumns;
  std::uint32_t low[kPlanes][kRows][kTileColumns], high[kPlanes][kRows][kTileColumns];

  /// By all threads of the block.
  __device__ void clear(unsigned thread, unsigned threads) {
    for (unsigned i = thread; i < kSums; i += threads) (&low[0][0][0])[i] = (&high[0][0][0])[i] = 0;
  }
  /// To `kCount` planes from the first on. Several threads may add to one sum. The halves one after
  /// another, so that the planes' additions do not wait for each other.
  template <int kCount>
  __device__ __forceinline__ void add(int first, int row, int column,
                                      const Fixed (&values)[kCount]) {
    std::uint32_t carry[kCount];
#pragma unroll
    for (int i = 0; i < kCount; ++i) {
      const auto part = static_cast<std::uint32_t>(values[i]);
      carry[i] = atomicAdd(&low[first + i][row][column], part) > ~part ? 1 : 0;
    }
#pragma unroll
    for (int i = 0; i < kCount; ++i)
      atomicAdd(&high[first + i][row][column],
                static_cast<std::uint32_t>(values[i] >> 32) + carry[i]);
  }
  [[nodiscard]] __device__ __forceinline__ Fixed at(int plane, int row, int column) const {
    return Fixed{high[plane][row][column]} << 32 | low[plane][row][column];
  }
  __device__ __forceinline__ void set(int plane, int row, int column, Fixed value) {
    low[plane][row][column] = static_cast<std::uint32_t>(value);
    high[plane][row][column] = static_cast<std::uint32_t>(value >> 32);
  }
  /// What is there, and leaves 0.
  __device__ __forceinline__ Fixed take(int plane, int row, int column) {
    const Fixed value = at(plane, row, column);
    set(plane, row, column, 0);
    return value;
  }
};

/// What lies between two places, [begin + begin_fraction, end + end_fraction), as steps of a
/// running sum over positions 0 to size − 1: what comes before them all is one step at 0, what
/// comes behind is left out. Where both places are in one position, two steps are enough.
class ClippedSteps {
 public:
  __device__ ClippedSteps(int begin, double begin_fraction, int end, double end_fraction, int size)
      : begin_(begin), end_(end) {
    const bool one = begin == end;
    const double width = end_fraction - begin_fraction;
    put(0, begin, one ? width : 1 - begin_fraction, size);
    put(1, begin + 1, one ? -width : begin_fraction, size);
    put(2, end, one ? 0 : end_fraction - 1, size);
    put(3, end + 1, one ? 0 : -end_fraction, size);
    if (end + 1 <= 0) first_ = 0;
  }
  static constexpr int kSteps = 5;
  /// The first is at 0. A weight of 0: there is no such step.
  [[nodiscard]] __device__ __forceinline__ int at(int i) const {
    return i == 0 ? 0 : i <= 2 ? begin_ + i - 1 : end_ + i - 3;
  }
  [[nodiscard]] __device__ __forceinline__ double weight(int i) const {
    return i == 0   ? first_
           : i == 1 ? weight_[0]
           : i == 2 ? weight_[1]
           : i == 3 ? weight_[2]
                    : weight_[3];
  }

 private:
  __device__ __forceinline__ void put(int i, int at, double weight, int size) {
    if (at <= 0) first_ += weight;
    weight_[i] = at <= 0 || at >= size ? 0 : weight;
  }

  int begin_, end_;
  double first_ = 0, weight_[4];
};

}  // namespace relumbre::cuda
