/// Internal: the kernel of form_factors_cuda.cu.
#pragma once

#include <cstdint>

#include "relumbre/base/device_math.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/warp.cuh"
#include "relumbre/geometry/label_locator.h"
#include "relumbre/radiosity/hit_labels.h"
#include "relumbre/radiosity/ray_maps.h"
#include "relumbre/visibility/bvh_traverse.h"

namespace relumbre::cuda {

/// An element whose rays are to be traced.
struct alignas(16) RowInput {
  std::uint32_t first_facet;  ///< its facets' records
  std::uint32_t first_share;  ///< their cumulative areas, where there are several
  std::uint32_t facets;
  std::uint32_t unused;
  DigitalShift shift;
};

/// Where the row's counts are, and what became of the other rays.
struct alignas(16) RowOutput {
  std::uint32_t first, nonzeros;
  std::uint32_t back_face, escaped;
};

/// A row while it is counted, in words:
///
///   nonzeros | back_face | escaped | count of column 0, 1, ... | one bit a column: counted?
///
/// All are zero between rows.
struct RowLayout {
  std::uint32_t columns;

  static constexpr std::uint32_t kNonzeros = 0, kBackFace = 1, kEscaped = 2, kCounts = 3;
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::uint32_t marks() const { return kCounts + columns; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::uint32_t mark_words() const {
    return (columns + 31) / 32;
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::uint32_t words() const { return marks() + mark_words(); }
};

/// A batch of rows, cut into tiles of a few that a block works on at a time.
struct RowBatch {
  BvhView scene;
  LabelView labels;
  const std::uint32_t* pattern;  ///< coordinate d of ray r at [d · stride + r]
  std::size_t stride;
  std::uint32_t rays;
  const RowInput* in;
  const float* records;  ///< 12 a facet: see EmittingSurface
  const float* shares;
  std::uint32_t rows, rows_per_tile;
  RowLayout layout;
  std::uint32_t* buffers;   ///< rows_per_tile rows a block, zero; null: they are in shared memory
  std::uint32_t* progress;  ///< tiles taken, and counts written; both zero
  RowOutput* out;
  std::uint32_t* column;
  std::uint32_t* count;
};

namespace form_factors_kernel {

inline constexpr unsigned kThreads = 128;
inline constexpr unsigned kWarps = kThreads / kWarp;

/// In shared memory; the rows of a tile follow where they are there too.
struct alignas(16) TileState {
  std::uint32_t tile;
  std::uint32_t next_chunk;
};

/// The column that a ray of a row lands on, or kAbsorbed or kEscaped.
__device__ __forceinline__ std::uint32_t land(const RowBatch& batch, std::uint32_t row,
                                              std::uint32_t ray) {
  const auto* in = reinterpret_cast<const Words4*>(batch.in + row);
  const Words4 facets = load_words(in), shift = load_words(in + 1);
  const auto coordinate = [&](std::uint32_t d, std::uint32_t by) {
    return ray_maps::to_cell(__ldg(batch.pattern + d * batch.stride + ray) ^ by);
  };
  ray_maps::Point point{coordinate(0, shift.x), coordinate(1, shift.y), coordinate(2, shift.z),
                        coordinate(3, shift.w)};
  const std::uint32_t facet = ray_maps::choose_facet(batch.shares + facets.y, facets.z, point.x);
  const ElementRay r = element_ray(batch.records + std::size_t{12} * (facets.x + facet), point);
  const BvhHit hit = trace<false>(
      batch.scene,
      {r.origin_x, r.origin_y, r.origin_z, 0, r.direction_x, r.direction_y, r.direction_z, 3e38F});
  if (!hit.hit()) return kEscaped;
  const std::uint32_t label = batch.labels.find(hit.triangle(), hit.back(), hit.u, hit.v);
  return label == kNone ? kAbsorbed : label;
}

/// Counts what the lanes of a warp landed on, all of one row. Lanes without a ray bring kNone.
__device__ __forceinline__ void count(const RowLayout& layout, std::uint32_t* row,
                                      std::uint32_t label, unsigned lane) {
  bool first = false;
  if (label < kAbsorbed) {
    first = atomicAdd(row + RowLayout::kCounts + label, 1U) == 0;
    if (first) atomicOr(row + layout.marks() + label / 32, 1U << (label % 32));
  }
  const unsigned firsts = __ballot_sync(kAllLanes, first);
  const unsigned absorbed = __ballot_sync(kAllLanes, label == kAbsorbed);
  const unsigned escaped = __ballot_sync(kAllLanes, label == kEscaped);
  if (lane != 0) return;
  if (firsts != 0) atomicAdd(row + RowLayout::kNonzeros, bit_count(firsts));
  if (absorbed != 0) atomicAdd(row + RowLayout::kBackFace, bit_count(absorbed));
  if (escaped != 0) atomicAdd(row + RowLayout::kEscaped, bit_count(escaped));
}

/// A tile's rays, a warp's worth at a time to whichever warp is free.
__device__ __forceinline__ void trace_tile(const RowBatch& batch, TileState& state,
                                           std::uint32_t* buffer, std::uint32_t first_row,
                                           std::uint32_t rows, unsigned lane) {
  const std::uint32_t chunks = (batch.rays + kWarp - 1) / kWarp;
  for (;;) {
    std::uint32_t chunk = 0;
    if (lane == 0) chunk = atomicAdd(&state.next_chunk, 1U);
    chunk = shuffle(chunk, 0);
    const std::uint32_t row = chunk / chunks, ray = chunk % chunks * kWarp + lane;
    if (row >= rows) return;
    const std::uint32_t label =
        ray < batch.rays ? land(batch, first_row + row, ray) : std::uint32_t{kNone};
    __syncwarp();
    count(batch.layout, buffer + std::size_t{row} * batch.layout.words(), label, lane);
  }
}

/// A warp writes out a row, in ascending order of columns, and leaves zeros.
__device__ __forceinline__ void flush_row(const RowBatch& batch, std::uint32_t* row,
                                          std::uint32_t index, unsigned lane) {
  const std::uint32_t nonzeros = row[RowLayout::kNonzeros];
  std::uint32_t first = 0;
  if (lane == 0) {
    first = atomicAdd(batch.progress + 1, nonzeros);
    batch.out[index] = {first, nonzeros, row[RowLayout::kBackFace], row[RowLayout::kEscaped]};
  }
  std::uint32_t at = shuffle(first, 0);
  __syncwarp();
  if (lane < RowLayout::kCounts) row[lane] = 0;
  std::uint32_t* marks = row + batch.layout.marks();
  for (std::uint32_t base = 0; base < batch.layout.mark_words(); base += kWarp) {
    const std::uint32_t word = base + lane;
    std::uint32_t bits = word < batch.layout.mark_words() ? marks[word] : 0;
    if (__any_sync(kAllLanes, bits != 0) == 0) continue;
    const std::uint32_t own = bit_count(bits);
    const std::uint32_t up_to =
        warp_inclusive_scan(own, lane, [](std::uint32_t a, std::uint32_t b) { return a + b; });
    for (std::uint32_t to = at + up_to - own; bits != 0; bits &= bits - 1, ++to) {
      const std::uint32_t column = 32 * word + lowest_bit(bits);
      batch.column[to] = column;
      batch.count[to] = row[RowLayout::kCounts + column];
      row[RowLayout::kCounts + column] = 0;
    }
    if (word < batch.layout.mark_words()) marks[word] = 0;
    at += shuffle(up_to, kWarp - 1);
  }
}

/// Blocks take tiles until there is none left. Grid: any number of blocks.
__global__ void __launch_bounds__(kThreads) trace_rows(const RowBatch batch) {
  TileState& state = shared_as<TileState>();
  const unsigned lane = threadIdx.x % kWarp, warp = threadIdx.x / kWarp;
  const std::size_t words = std::size_t{batch.rows_per_tile} * batch.layout.words();
  auto* buffer = reinterpret_cast<std::uint32_t*>(&state + 1);
  if (batch.buffers != nullptr) {
    buffer = batch.buffers + blockIdx.x * words;
  } else {
    for (std::size_t i = threadIdx.x; i < words; i += kThreads) buffer[i] = 0;
  }
  const std::uint32_t tiles = (batch.rows + batch.rows_per_tile - 1) / batch.rows_per_tile;
  for (;;) {
    if (threadIdx.x == 0) state = {atomicAdd(batch.progress, 1U), 0};
    __syncthreads();
    if (state.tile >= tiles) return;
    const std::uint32_t first = state.tile * batch.rows_per_tile;
    const std::uint32_t rows = ::min(batch.rows_per_tile, batch.rows - first);
    trace_tile(batch, state, buffer, first, rows, lane);
    __syncthreads();
    for (std::uint32_t row = warp; row < rows; row += kWarps)
      flush_row(batch, buffer + row * std::size_t{batch.layout.words()}, first + row, lane);
    __syncthreads();
  }
}

}  // namespace form_factors_kernel
}  // namespace relumbre::cuda
