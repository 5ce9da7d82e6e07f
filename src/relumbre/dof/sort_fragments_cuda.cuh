/// Device-only: the passes of the sort. Each fragment is prepared and counted, rows of cells get
/// their places, each fragment is put in its own.
#pragma once

#include <algorithm>
#include <cstdint>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/dof/fragments_cuda.cuh"
#include "relumbre/dof/sort_fragments_cuda.h"

namespace relumbre::cuda {

inline constexpr unsigned kSortThreads = 256;

struct Count {
  __device__ unsigned operator()(unsigned a, unsigned b) const { return a + b; }
};

__device__ __forceinline__ std::size_t sort_thread() {
  return std::size_t{blockIdx.x} * kSortThreads + threadIdx.x;
}
__device__ __forceinline__ std::size_t sort_threads() {
  return std::size_t{gridDim.x} * kSortThreads;
}

/// Of the largest |colour|, as it is divided out of fragments: a power of two.
__device__ __forceinline__ int exponent_of(const FragmentSummary* summary) {
  int exponent = 0;
  frexpf(__uint_as_float(summary->brightest), &exponent);
  return exponent;
}
__device__ __forceinline__ Rgba scaled_down(const Rgba& c, const FragmentSummary* summary) {
  const int by = -exponent_of(summary);
  return {ldexpf(c.r, by), ldexpf(c.g, by), ldexpf(c.b, by), ldexpf(c.a, by)};
}

__device__ __forceinline__ std::size_t cell_of(const SortedFragments& sort, std::uint32_t x,
                                               std::uint32_t y, std::uint32_t layer) {
  return (std::size_t{layer} * sort.cell_rows + y / kCellRows) * sort.cell_columns +
         x / kCellColumns;
}

/// Adds one, with one atomic for all lanes of the warp that add to the same counter; returns what
/// was there, as if they had come one after another. All lanes call it.
__device__ inline std::uint32_t count_one(std::uint32_t* counters, std::size_t which, bool active) {
  const unsigned lane = threadIdx.x % kWarp;
  const unsigned long long key = active ? which : ~0ULL;
  const unsigned same = __match_any_sync(kAllLanes, key);
  const unsigned leader = static_cast<unsigned>(__ffs(static_cast<int>(same))) - 1;
  std::uint32_t before = 0;
  if (active && lane == leader)
    before = atomicAdd(&counters[which], static_cast<std::uint32_t>(__popc(same)));
  before = __shfl_sync(kAllLanes, before, static_cast<int>(leader));
  return before + static_cast<std::uint32_t>(__popc(same & ((1U << lane) - 1)));
}

/// `Table`: kEntries; prepare(f, sort), which also finds f.layer; entries(f), how many of the
/// layers from there on the fragment is in.
template <class Table>
__global__ void __launch_bounds__(kSortThreads)
    prepare_fragments(SortedFragments sort, Table table) {
  const std::size_t count = sort.summary->count;
  // Whole warps stay together: they count together.
  for (std::size_t i = sort_thread(); i / kWarp * kWarp < count; i += sort_threads()) {
    const bool active = i < count;
    DeviceFragment f{};
    if (active) {
      f = sort.fragments[i];
      table.prepare(f, sort);
      raise_to(&sort.reach[f.layer], __float_as_uint(std::abs(f.coc)));
      sort.fragments[i] = f;
    }
#pragma unroll
    for (unsigned e = 0; e < Table::kEntries; ++e)
      count_one(sort.counts, cell_of(sort, f.x, f.y, f.layer + e), active && e < table.entries(f));
  }
}

/// Moves `ends` on to where cells end.
template <class Table>
__global__ void __launch_bounds__(kSortThreads) order_fragments(SortedFragments sort, Table table) {
  const std::size_t count = sort.summary->count;
  for (std::size_t i = sort_thread(); i / kWarp * kWarp < count; i += sort_threads()) {
    const bool active = i < count;
    DeviceFragment f{};
    if (active) f = sort.fragments[i];
#pragma unroll
    for (unsigned e = 0; e < Table::kEntries; ++e) {
      const bool there = active && e < table.entries(f);
      const std::uint32_t at = count_one(sort.ends, cell_of(sort, f.x, f.y, f.layer + e), there);
      if (there) sort.order[at] = static_cast<std::uint32_t>(i) * Table::kEntries + e;
    }
  }
}

/// The whole sort, after FragmentSorter::begin().
template <class Table>
void sort_fragments(const SortedFragments& sort, const Table& table, const Stream& stream) {
  const auto blocks = [&](auto kernel) {
    return Grid{.blocks = static_cast<unsigned>(resident_blocks(kernel, kSortThreads)),
                .threads = kSortThreads};
  };
  launch(prepare_fragments<Table>, blocks(prepare_fragments<Table>), stream, sort, table);
  place_cells(sort, stream);
  launch(order_fragments<Table>, blocks(order_fragments<Table>), stream, sort, table);
}

}  // namespace relumbre::cuda
