/// Device-only: a tile of the picture, to which a block spreads what reaches it, layer by layer.
#pragma once

#include <algorithm>
#include <cstdint>

#include "relumbre/dof/cover.h"
#include "relumbre/dof/lane_sums.h"
#include "relumbre/dof/sort_fragments_cuda.cuh"
#include "relumbre/dof/spread_blurs_cuda.cuh"

namespace relumbre::cuda {

struct BlockScan {
  unsigned before, total;
};
/// Σ of the values of the threads before this one, and of all. All threads call it.
__device__ inline BlockScan block_scan(unsigned value, std::uint32_t* warps) {
  const unsigned lane = threadIdx.x % kWarp, warp = threadIdx.x / kWarp;
  const unsigned upto = warp_inclusive_scan(value, lane, Count{});
  if (lane == kWarp - 1) warps[warp] = upto;
  __syncthreads();
  BlockScan result{upto - value, 0};
  for (unsigned w = 0; w < kTileWarps; ++w) {
    if (w < warp) result.before += warps[w];
    result.total += warps[w];
  }
  __syncthreads();
  return result;
}
/// Whether it is so for any thread. All threads call it.
__device__ inline bool block_any(bool so, std::uint32_t* warps) {
  return block_scan(so ? 1 : 0, warps).total > 0;
}

/// The repetitions of a fragment (most have one, which is itself) that may reach a tile: a
/// rectangle of places.
struct Candidate {
  std::uint32_t fragment;
  std::uint32_t before;  ///< repetitions of the candidates before it
  int x, y, columns;
};

/// Blocks that a multiprocessor is to have room for: with more, registers would be spilled.
inline constexpr unsigned kTileBlocks = 2;

/// Layers that are looked for in a tile at once.
inline constexpr std::uint32_t kPresence = 64;

template <class Blurs>
struct TileMemory {
  typename Blurs::Memory blurs;
  std::uint32_t run_end[kTileThreads], run_shift[kTileThreads];
  Candidate candidates[kTileThreads];
  std::uint32_t owner[kTileThreads];
  std::uint32_t present[kPresence / 32];
  std::uint32_t warps[kTileWarps];
};

/// Finds what of a layer reaches a tile, and gives every thread one repetition after another.
template <class Blurs>
class TileSources {
 public:
  using Table = typename Blurs::Table;

  __device__ TileSources(TileMemory<Blurs>& memory, const SortedFragments& sorted,
                         const Table& table, int left, int top)
      : memory_(memory), sorted_(sorted), table_(table), left_(left), top_(top) {}

  /// Of kPresence layers from `group` on, those that have entries in cells near enough: a bit each
  /// in memory.present. A warp looks at a layer.
  __device__ void look(std::uint32_t group) {
    const unsigned lane = threadIdx.x % kWarp;
    for (unsigned i = threadIdx.x / kWarp; i < kPresence; i += kTileWarps) {
      bool any = false;
      if (group + i < sorted_.layers) {
        const Near near = near_cells(group + i);
        for (std::uint32_t row = near.first_row + lane; row <= near.last_row; row += kWarp)
          any = any || run_of(near, group + i, row).count > 0;
      }
      if (__any_sync(kAllLanes, any) == 0) continue;
      if (lane == 0) atomicOr(&memory_.present[i / 32], 1U << (i % 32));
    }
  }

  /// Entries of the layer in cells that are near enough: rows of cells, in each of which they
  /// follow one another. A thread a row, which is enough for the largest blurs.
  __device__ unsigned find(std::uint32_t layer) {
    static_assert(kTileThreads * kCellRows > 1.1 * ApertureKernels::kLargest + 2 * Blurs::kRows);
    layer_ = layer;
    const Near near = near_cells(layer);
    const std::uint32_t row = near.first_row + threadIdx.x;
    const Run run = row <= near.last_row ? run_of(near, layer, row) : Run{};
    const BlockScan scan = block_scan(run.count, memory_.warps);
    memory_.run_end[threadIdx.x] = scan.before + run.count;
    memory_.run_shift[threadIdx.x] = run.start - scan.before;
    __syncthreads();
    return scan.total;
  }

  /// Spreads all of `total` entries found.
  __device__ void spread(unsigned total, Blurs& blurs) {
    for (unsigned chunk = 0; chunk < total; chunk += kTileThreads) {
      const unsigned i = chunk + threadIdx.x;
      unsigned count = 0;
      Candidate candidate{};
      if (i < total) count = repetitions(entry_at(i), candidate);
      const BlockScan scan = block_scan(count, memory_.warps);
      candidate.before = scan.before;
      memory_.candidates[threadIdx.x] = candidate;
      for (unsigned base = 0; base < scan.total; base += kTileThreads) {
        claim(scan.before, count, base);
        __syncthreads();
        const unsigned left = scan.total - base, batch = left < kTileThreads ? left : kTileThreads;
        if (threadIdx.x < batch) blurs.bring(source(base + threadIdx.x));
        __syncthreads();
        blurs.write(batch);
      }
    }
  }

 private:
  struct Near {
    std::uint32_t first, last, first_row, last_row;  ///< columns and rows of cells
  };
  struct Run {
    std::uint32_t start = 0, count = 0;  ///< in the order
  };
  [[nodiscard]] __device__ Near near_cells(std::uint32_t layer) const {
    const int reach = table_.layer_reach(sorted_, layer);
    return {cell(left_ - reach, kCellColumns, sorted_.cell_columns),
            cell(left_ + kTileColumns - 1 + reach, kCellColumns, sorted_.cell_columns),
            cell(top_ - reach, kCellRows, sorted_.cell_rows),
            cell(top_ + Blurs::kRows - 1 + reach, kCellRows, sorted_.cell_rows)};
  }
  [[nodiscard]] __device__ Run run_of(const Near& near, std::uint32_t layer,
                                      std::uint32_t row) const {
    const std::size_t cells = (std::size_t{layer} * sorted_.cell_rows + row) * sorted_.cell_columns;
    const std::uint32_t start =
        sorted_.ends[cells + near.first] - sorted_.counts[cells + near.first];
    return {start, sorted_.ends[cells + near.last] - start};
  }
  [[nodiscard]] __device__ static std::uint32_t cell(int at, std::uint32_t size,
                                                     std::uint32_t cells) {
    return at <= 0 ? 0 : std::min(static_cast<std::uint32_t>(at) / size, cells - 1);
  }
  [[nodiscard]] __device__ std::uint32_t entry_at(unsigned i) const {
    unsigned low = 0, high = kTileThreads - 1;  // the first run that ends behind i
    while (low < high) {
      const unsigned middle = (low + high) / 2;
      if (memory_.run_end[middle] > i)
        high = middle;
      else
        low = middle + 1;
    }
    return sorted_.order[i + memory_.run_shift[low]];
  }
  __device__ unsigned repetitions(std::uint32_t entry, Candidate& candidate) const {
    const std::uint32_t fragment = entry / Table::kEntries;
    const DeviceFragment& f = sorted_.fragments[fragment];
    const int reach = table_.reach(table_.blur(f, layer_));
    const Repeats across = repeats(f.x, static_cast<int>(sorted_.width), reach, reach),
                  down = repeats(f.y, static_cast<int>(sorted_.height), reach, reach);
    const int x = std::max(across.first, left_ - reach), y = std::max(down.first, top_ - reach);
    const int columns = std::min(across.last, left_ + kTileColumns - 1 + reach) - x + 1,
              rows = std::min(down.last, top_ + Blurs::kRows - 1 + reach) - y + 1;
    candidate = {fragment, 0, x, y, columns};
    return columns > 0 && rows > 0 ? static_cast<unsigned>(columns) * static_cast<unsigned>(rows)
                                   : 0;
  }
  /// Of the batch that begins at `base`, the places of this thread's repetitions.
  __device__ void claim(unsigned before, unsigned count, unsigned base) {
    const unsigned end = std::min(before + count, base + kTileThreads);
    for (unsigned i = std::max(before, base); i < end; ++i) memory_.owner[i - base] = threadIdx.x;
  }
  [[nodiscard]] __device__ Source source(unsigned i) const {
    const Candidate& candidate = memory_.candidates[memory_.owner[i % kTileThreads]];
    const DeviceFragment& f = sorted_.fragments[candidate.fragment];
    const int place = static_cast<int>(i - candidate.before);
    const float share = table_.share(f, layer_);
    return {candidate.x + place % candidate.columns - left_,
            candidate.y + place / candidate.columns - top_,
            table_.blur(f, layer_),
            f.slope.x,
            f.slope.y,
            {share * f.color.r, share * f.color.g, share * f.color.b,
             share * (Blurs::kOpaque ? f.coverage : f.color.a), share * f.coverage}};
  }

  TileMemory<Blurs>& memory_;
  const SortedFragments& sorted_;
  const Table& table_;
  int left_, top_;
  std::uint32_t layer_ = 0;
};

/// A tile's pixels, two of each row a thread.
template <class Blurs>
class TileCover {
 public:
  __device__ TileCover(const SortedFragments& sorted, int left, int top)
      : sorted_(sorted), left_(left), top_(top) {}

  /// Row r of the thread's warp: what is in front of it is there already.
  template <class Row>
  __device__ void add(int r, const Row& row, double tolerance) {
    const double bright = ldexp(1.0, exponent_of(sorted_.summary));
#pragma unroll
    for (int j = 0; j < 2; ++j) {
      const auto lane = [&](int q) {
        return static_cast<float>(double_of(row.sum[q][j]) * bright);
      };
      const double weight = double_of(row.sum[Blurs::kLaneCount - 1][j]);
      const Rgba sum{lane(0), lane(1), lane(2),
                     Blurs::kOpaque ? static_cast<float>(weight) : lane(3)};
      PixelCover{color_[r][j], weight_[r][j], share_[r][j]}.add(sum, weight, tolerance);
    }
  }
  /// Something of a layer farther away may still be seen.
  [[nodiscard]] __device__ bool open() const {
    bool any = false;
#pragma unroll
    for (int r = 0; r < Blurs::kRowsPerWarp; ++r)
#pragma unroll
      for (int j = 0; j < 2; ++j) any = any || (inside(r, j) && share_[r][j] < 1);
    return any;
  }
  __device__ void write(Rgba* picture) {
#pragma unroll
    for (int r = 0; r < Blurs::kRowsPerWarp; ++r)
#pragma unroll
      for (int j = 0; j < 2; ++j)
        if (inside(r, j))
          picture[static_cast<std::size_t>(row(r)) * sorted_.width +
                  static_cast<std::size_t>(column(j))] =
              PixelCover{color_[r][j], weight_[r][j], share_[r][j]}.whole();
  }

 private:
  [[nodiscard]] __device__ int row(int r) const {
    return top_ + static_cast<int>(threadIdx.x / kWarp) + r * static_cast<int>(kTileWarps);
  }
  [[nodiscard]] __device__ int column(int j) const {
    return left_ + 2 * static_cast<int>(threadIdx.x % kWarp) + j;
  }
  [[nodiscard]] __device__ bool inside(int r, int j) const {
    return column(j) < static_cast<int>(sorted_.width) && row(r) < static_cast<int>(sorted_.height);
  }

  const SortedFragments& sorted_;
  int left_, top_;
  Rgba color_[Blurs::kRowsPerWarp][2] = {};
  double weight_[Blurs::kRowsPerWarp][2] = {}, share_[Blurs::kRowsPerWarp][2] = {};
};

/// A block a tile, row by row of tiles. `result`: premultiplied colours.
///
/// Of `Table`, beside what Blurs and the sort ask of it: blur(f, layer), the size of a fragment's
/// blur in a layer; share(f, layer), how much of the fragment is in it; reach(blur), pixels to
/// either side that it touches, or a few more; layer_reach(sorted, layer), the largest of a layer;
/// diameter(sorted, layer), for the cover's tolerance.
template <class Blurs>
__global__ void __launch_bounds__(kTileThreads, kTileBlocks)
    spread_tiles(SortedFragments sorted, typename Blurs::Table table, Rgba* result) {
  auto& memory = shared_as<TileMemory<Blurs>>();
  const unsigned tiles = (sorted.width + kTileColumns - 1) / kTileColumns;
  const int left = static_cast<int>(blockIdx.x % tiles) * kTileColumns,
            top = static_cast<int>(blockIdx.x / tiles) * Blurs::kRows;
  memory.blurs.planes.clear(threadIdx.x, kTileThreads);
  Blurs blurs(memory.blurs, table);
  TileSources<Blurs> sources(memory, sorted, table, left, top);
  TileCover<Blurs> cover(sorted, left, top);
  const auto add_layer = [&](std::uint32_t layer) {
    sources.spread(sources.find(layer), blurs);
    const double tolerance = tolerance_of(table.diameter(sorted, layer));
    blurs.add_up([&](int r, const auto& row) { cover.add(r, row, tolerance); });
    return block_any(cover.open(), memory.warps);
  };
  bool open = true;
  for (std::uint32_t group = 0; open && group < sorted.layers; group += kPresence) {
    __syncthreads();  // the planes are clear, and the last group's bits are read
    if (threadIdx.x < kPresence / 32) memory.present[threadIdx.x] = 0;
    __syncthreads();
    sources.look(group);
    __syncthreads();
    for (std::uint32_t i = 0; open && i < kPresence; ++i)
      if ((memory.present[i / 32] >> (i % 32) & 1) != 0) open = add_layer(group + i);
  }
  cover.write(result);
}

template <class Blurs>
void spread_all(const SortedFragments& sorted, const typename Blurs::Table& table, Rgba* result,
                const Stream& stream) {
  const unsigned columns = (sorted.width + kTileColumns - 1) / kTileColumns,
                 rows = (sorted.height + Blurs::kRows - 1) / Blurs::kRows;
  launch(spread_tiles<Blurs>,
         {.blocks = columns * rows,
          .threads = kTileThreads,
          .shared_bytes = sizeof(TileMemory<Blurs>)},
         stream, sorted, table, result);
}

/// Sorts the fragments and spreads them over the whole picture.
template <template <int, class> class Blurs, class Table>
void spread_picture(const SortedFragments& sorted, const Table& table, bool opaque, Rgba* result,
                    const Stream& stream) {
  sort_fragments(sorted, table, stream);
  if (opaque)
    spread_all<Blurs<4, Table>>(sorted, table, result, stream);
  else
    spread_all<Blurs<5, Table>>(sorted, table, result, stream);
}

}  // namespace relumbre::cuda
