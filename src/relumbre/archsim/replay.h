/// The order in which a geometry unit works through a trace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "relumbre/archsim/tiles.h"
#include "relumbre/archsim/trace.h"

namespace relumbre {

/// What one unit does between two tile borders: rays of neighbouring pixels of a row.
struct TraceRun {
  std::uint64_t rays = 0, tasks = 0;
  std::span<const std::uint8_t> reads;  ///< of all of them, in order
};

/// Calls run(TraceRun) for each row of each tile of the unit, in order. A place in the trace is
/// kept for each row of a tile, so that only the counts of the unit's own pixels are added up.
template <class Run>
void replay(const Trace& trace, const Tiles& tiles, std::uint32_t unit, Run&& run) {
  struct Cursor {
    std::uint32_t row = std::numeric_limits<std::uint32_t>::max();
    std::span<const std::uint8_t> rest;
  };
  const std::size_t width = trace.shape().width;
  std::vector<Cursor> cursors;  // row y of the picture: cursor y mod size, the tile's height
  const auto sum = [](std::span<const std::uint32_t> counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  };
  const Tiles::Range owned = tiles.owned_by(unit);
  if (owned.begin < owned.end) cursors.resize(tiles.tile(0).y1);
  tiles.for_each_run(unit, [&](std::uint32_t y, std::uint32_t x0, std::uint32_t x1) {
    const std::size_t first = y * width + x0, count = x1 - x0;
    Cursor& cursor = cursors[y % cursors.size()];
    if (cursor.row != y) {
      const std::uint64_t before = sum(trace.read_counts().subspan(y * width, x0));
      cursor = {y, trace.row_reads(y).subspan(before)};
    }
    const std::uint64_t reads = sum(trace.read_counts().subspan(first, count));
    run(TraceRun{count, sum(trace.tasks().subspan(first, count)), cursor.rest.first(reads)});
    cursor.rest = cursor.rest.subspan(reads);
  });
}

}  // namespace relumbre
