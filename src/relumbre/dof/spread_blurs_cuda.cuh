/// Device-only: how the two kinds of blur are written into a tile as steps, and summed up.
#pragma once

#include <cmath>
#include <cstdint>

#include "relumbre/dof/aperture_kernel.h"
#include "relumbre/dof/fixed_planes_cuda.cuh"

namespace relumbre::cuda {

inline constexpr unsigned kTileThreads = 256, kTileWarps = kTileThreads / kWarp;

/// A blur to be written: that of a fragment, or of its repetition beyond the picture's border.
/// Columns and rows count from the tile's corner.
struct Source {
  int column, row;
  float blur;  ///< its size, as the table understands it
  float tilt_right, tilt_down;
  float light[5];  ///< red, green, blue, perhaps alpha; the last is the weight
};

/// A row of sums as its warp adds it up, two columns a lane.
template <int kLanes>
struct RowSums {
  Fixed sum[kLanes][2];

  __device__ __forceinline__ static Fixed scan(Fixed value, unsigned lane) {
    return warp_inclusive_scan(value, lane, FixedSum{});
  }
};

/// Blurs of any outline, row by row. Every row of the tile belongs to one warp. Sums are a value
/// and a slope a lane: see SpreadSums. `ATable` has head(blur), a KernelHead, and spans.
template <int kLanes, class ATable>
class RowBlurs {
 public:
  using Table = ATable;
  static constexpr int kLaneCount = kLanes;
  static constexpr bool kOpaque = kLanes == 4;
  static constexpr int kRows = 8, kRowsPerWarp = kRows / static_cast<int>(kTileWarps);
  using Planes = FixedPlanes<2 * kLanes, kRows>;
  /// A Source, ready for all warps.
  struct Record {
    Source source;
    int top, bottom;       ///< rows that it reaches, from the tile's
    std::uint32_t middle;  ///< the span of the source's row (modulo 2^32)
  };
  struct Memory {
    Planes planes;
    Record records[kTileThreads];
  };

  __device__ RowBlurs(Memory& memory, const Table& table) : memory_(memory), table_(table) {}

  /// Before the barrier: each thread its source.
  __device__ void bring(const Source& source) {
    const auto& head = table_.head(source.blur);
    memory_.records[threadIdx.x] = {source, source.row + head.top, source.row + head.bottom,
                                    head.first - static_cast<std::uint32_t>(head.top)};
  }
  /// Behind it: each warp its row of all of them.
  __device__ void write(unsigned count) {
    const int row = static_cast<int>(threadIdx.x / kWarp);
    for (unsigned i = threadIdx.x % kWarp; i < count; i += kWarp) {
      const Record& record = memory_.records[i];
      if (row >= record.top && row < record.bottom) write_row(record, row);
    }
  }
  /// Calls use(0, sums) with those of the warp's row, if there are any. Leaves no steps.
  template <class Use>
  __device__ void add_up(Use&& use) {
    if (__any_sync(kAllLanes, written_) == 0) return;
    const unsigned lane = threadIdx.x % kWarp;
    const bool sloped = __any_sync(kAllLanes, sloped_) != 0;
    RowSums<kLanes> row;
#pragma unroll
    for (int q = 0; q < kLanes; ++q) {
      Fixed before = 0, here = 0;  // the slope left of the lane's columns, and at the first
      if (sloped) {
        const auto [a, b] = steps_of(kLanes + q, lane);
        const Fixed upto = RowSums<kLanes>::scan(a + b, lane);
        before = upto - a - b, here = upto - b;
      }
      const auto [a, b] = steps_of(q, lane);
      const Fixed second = b + here;
      const Fixed upto = RowSums<kLanes>::scan(a + before + second, lane);
      row.sum[q][0] = upto - second, row.sum[q][1] = upto;
    }
    written_ = sloped_ = false;
    use(0, row);
  }

 private:
  struct Pair {
    Fixed a, b;
  };
  /// The steps at a lane's two columns, and those before the tile in the first.
  __device__ __forceinline__ Pair steps_of(int plane, unsigned lane) {
    const int row = static_cast<int>(threadIdx.x / kWarp), column = 2 * static_cast<int>(lane);
    const Fixed first = warp_total(first_[plane]);
    first_[plane] = 0;
    const Fixed a = memory_.planes.take(plane, row, column);
    return {lane == 0 ? a + first : a, memory_.planes.take(plane, row, column + 1)};
  }
  __device__ void write_row(const Record& record, int row) {
    const Source& source = record.source;
    const int down = row - source.row;
    const ApertureKernel::Span span =
        table_.spans[record.middle + static_cast<std::uint32_t>(down)];
    const ClippedSteps steps(source.column + span.begin, static_cast<double>(span.begin_fraction),
                             source.column + span.end, static_cast<double>(span.end_fraction),
                             kTileColumns);
    const auto right = static_cast<double>(source.tilt_right);
    const double level = 1 + static_cast<double>(source.tilt_down) * down;
    written_ = true;
    if (right != 0) sloped_ = true;
#pragma unroll
    for (int i = 0; i < ClippedSteps::kSteps; ++i) {
      if (steps.weight(i) == 0) continue;
      const int column = steps.at(i);
      const double weight = steps.weight(i) * static_cast<double>(span.height);
      const double value = weight * (level + right * (column - source.column));
      step(i == 0, 0, row, column, source.light, value);
      if (right != 0) step(i == 0, kLanes, row, column, source.light, weight * right);
    }
  }
  /// Of all lanes' values, or slopes.
  __device__ __forceinline__ void step(bool first, int plane, int row, int column,
                                       const float* light, double weight) {
    Fixed fixed[kLanes];
#pragma unroll
    for (int q = 0; q < kLanes; ++q) fixed[q] = fixed_of(static_cast<double>(light[q]) * weight);
    if (!first) return memory_.planes.add(plane, row, column, fixed);
#pragma unroll
    for (int q = 0; q < kLanes; ++q) first_[plane + q] += fixed[q];
  }

  Memory& memory_;
  const Table& table_;
  Fixed first_[2 * kLanes] = {};  ///< steps before the tile, which all lanes would add to one sum
  bool written_ = false, sloped_ = false;
};

/// Upright rectangles: steps at the four corners, summed up down the columns and along the rows.
/// `ATable` has half_width(blur) and half_height(blur).
template <int kLanes, class ATable>
class BoxBlurs {
 public:
  using Table = ATable;
  static constexpr int kLaneCount = kLanes;
  static constexpr bool kOpaque = kLanes == 4;
  static constexpr int kRows = 16, kRowsPerWarp = kRows / static_cast<int>(kTileWarps);
  using Planes = FixedPlanes<kLanes, kRows>;
  struct Memory {
    Planes planes;
  };

  __device__ BoxBlurs(Memory& memory, const Table& table) : memory_(memory), table_(table) {}

  __device__ void bring(const Source& source) { mine_ = source; }
  __device__ void write(unsigned count) {
    if (threadIdx.x >= count) return;
    const ClippedSteps columns =
        steps_of(mine_.column, table_.half_width(mine_.blur), kTileColumns);
    const ClippedSteps rows = steps_of(mine_.row, table_.half_height(mine_.blur), kRows);
#pragma unroll 1
    for (int j = 0; j < ClippedSteps::kSteps; ++j) {
      const double of_row = rows.weight(j);
      if (of_row != 0) write_row(columns, rows.at(j), of_row);
    }
  }
  /// Calls use(r, sums) for the r-th row of the warp. Leaves no steps.
  template <class Use>
  __device__ void add_up(Use&& use) {
    flush_first();
    __syncthreads();
    for (unsigned i = threadIdx.x; i < kLanes * kTileColumns; i += kTileThreads)
      add_down(static_cast<int>(i / kTileColumns), static_cast<int>(i % kTileColumns));
    __syncthreads();
    const unsigned lane = threadIdx.x % kWarp;
    const int column = 2 * static_cast<int>(lane);
#pragma unroll
    for (int r = 0; r < kRowsPerWarp; ++r) {
      const int y = static_cast<int>(threadIdx.x / kWarp) + r * static_cast<int>(kTileWarps);
      RowSums<kLanes> row;
#pragma unroll
      for (int q = 0; q < kLanes; ++q) {
        const Fixed a = memory_.planes.take(q, y, column),
                    b = memory_.planes.take(q, y, column + 1);
        const Fixed upto = RowSums<kLanes>::scan(a + b, lane);
        row.sum[q][0] = upto - b, row.sum[q][1] = upto;
      }
      use(r, row);
    }
  }

 private:
  /// From `reach` before a pixel's middle to `reach` behind it.
  __device__ static ClippedSteps steps_of(int pixel, double reach, int size) {
    const double begin = pixel - reach + 0.5, end = pixel + reach + 0.5;
    const double from = std::floor(begin), to = std::floor(end);
    return {static_cast<int>(from), begin - from, static_cast<int>(to), end - to, size};
  }
  __device__ void write_row(const ClippedSteps& columns, int row, double of_row) {
#pragma unroll
    for (int i = 0; i < ClippedSteps::kSteps; ++i) {
      const double weight = columns.weight(i) * of_row;
      if (weight == 0) continue;
      Fixed fixed[kLanes];
#pragma unroll
      for (int q = 0; q < kLanes; ++q)
        fixed[q] = fixed_of(static_cast<double>(mine_.light[q]) * weight);
      if (i == 0 && row == 0) {
#pragma unroll
        for (int q = 0; q < kLanes; ++q) first_[q] += fixed[q];
      } else {
        memory_.planes.add(0, row, columns.at(i), fixed);
      }
    }
  }
  __device__ void flush_first() {
#pragma unroll
    for (int q = 0; q < kLanes; ++q) first_[q] = warp_total(first_[q]);
    if (threadIdx.x % kWarp == 0) memory_.planes.add(0, 0, 0, first_);
#pragma unroll
    for (int q = 0; q < kLanes; ++q) first_[q] = 0;
  }
  __device__ void add_down(int plane, int column) {
    Fixed sum = 0;
#pragma unroll
    for (int row = 0; row < kRows; ++row) {
      sum += memory_.planes.at(plane, row, column);
      memory_.planes.set(plane, row, column, sum);
    }
  }

  Memory& memory_;
  const Table& table_;
  Source mine_{};
  Fixed first_[kLanes] = {};  ///< steps before the tile's corner
};

}  // namespace relumbre::cuda
