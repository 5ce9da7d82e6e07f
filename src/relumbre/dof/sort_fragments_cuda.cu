#include <string>

#include "relumbre/base/error.h"
#include "relumbre/cuda/device.h"
#include "relumbre/dof/sort_fragments_cuda.cuh"
#include "relumbre/dof/sort_fragments_cuda.h"

namespace relumbre::cuda {

namespace {

/// A warp a row.
__global__ void __launch_bounds__(kSortThreads) place_rows(SortedFragments sort) {
  const unsigned lane = threadIdx.x % kWarp;
  const std::size_t row = sort_thread() / kWarp;
  if (row >= std::size_t{sort.layers} * sort.cell_rows) return;
  const std::uint32_t* counts = sort.counts + row * sort.cell_columns;
  std::uint32_t* ends = sort.ends + row * sort.cell_columns;
  std::uint32_t mine = 0;
  for (unsigned i = lane; i < sort.cell_columns; i += kWarp) mine += counts[i];
  const std::uint32_t whole = shuffle(warp_inclusive_scan(mine, lane, Count{}), kWarp - 1);
  std::uint32_t place = 0;
  if (lane == 0 && whole > 0) place = atomicAdd(sort.total, whole);
  place = shuffle(place, 0);
  for (unsigned first = 0; first < sort.cell_columns; first += kWarp) {
    const unsigned i = first + lane;
    const std::uint32_t count = i < sort.cell_columns ? counts[i] : 0;
    const std::uint32_t upto = warp_inclusive_scan(count, lane, Count{});
    if (i < sort.cell_columns) ends[i] = place + upto - count;
    place += shuffle(upto, kWarp - 1);
  }
}

std::size_t most_fragments(std::size_t pixels, bool behind) { return pixels * (behind ? 3 : 2); }

std::uint32_t round_up(std::size_t size, std::uint32_t step) {
  return static_cast<std::uint32_t>((size + step - 1) / step);
}

}  // namespace

void place_cells(const SortedFragments& sort, const Stream& stream) {
  const std::size_t warps = std::size_t{sort.layers} * sort.cell_rows;
  launch(place_rows, {.blocks = round_up(warps * kWarp, kSortThreads), .threads = kSortThreads},
         stream, sort);
}

FragmentSorter::FragmentSorter(std::size_t pixels, bool behind, unsigned entries)
    : order_(most_fragments(pixels, behind) * entries) {}

std::size_t FragmentSorter::bytes_of(std::size_t pixels, bool behind, unsigned entries) {
  return most_fragments(pixels, behind) * entries * sizeof(std::uint32_t);
}

SortedFragments FragmentSorter::begin(const DevicePicture& picture,
                                      const DeviceFragments& fragments, std::size_t layers,
                                      const Stream& stream) {
  if (layers == 0) throw ValueError("layers: 0 asked, at least 1 is needed");
  if (layers > kMostLayers)
    throw ValueError("layers: " + std::to_string(layers) + " asked, the device has " +
                     std::to_string(kMostLayers) + " at most");
  SortedFragments sort{.fragments = fragments.data(),
                       .order = order_.data(),
                       .ends = nullptr,
                       .counts = nullptr,
                       .reach = nullptr,
                       .total = nullptr,
                       .summary = fragments.summary(),
                       .layers = static_cast<std::uint32_t>(layers),
                       .width = static_cast<std::uint32_t>(picture.width()),
                       .height = static_cast<std::uint32_t>(picture.height()),
                       .cell_columns = round_up(picture.width(), kCellColumns),
                       .cell_rows = round_up(picture.height(), kCellRows)};
  // counts of cells, reach of layers, total; then ends of cells, which need not be cleared
  const std::size_t cells = sort.cells(), cleared = cells + layers + 1, all = cleared + cells;
  if (all > cells_.size()) {
    cells_ = {};
    expect_free(all * sizeof(std::uint32_t), "depth of field: layers");
    cells_.reserve(all);
  }
  clear(cells_.data(), cleared, stream);
  sort.counts = cells_.data();
  sort.reach = sort.counts + cells;
  sort.total = sort.reach + layers;
  sort.ends = sort.total + 1;
  return sort;
}

}  // namespace relumbre::cuda
