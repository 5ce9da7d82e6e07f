/// Scans over tiles by one thread or by all.
///
/// Tiles depend on the size only, and the prefixes of tiles are folded one after another whoever
/// scans them, so that results have the same bits for any number of threads. The operation itself
/// must not run a parallel loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/parts.h"
#include "relumbre/scan/relay.h"
#include "relumbre/scan/tiles.h"

namespace relumbre::chained {

/// Scans `tiles` and returns the total. `in_parts`: they stay in the caches from one scan to the
/// next, and results do not overwrite elements.
template <Work W, class Value = ValueOf<W>>
Value scan_tiles(const Tiles& tiles, bool in_parts, W& work) {
  const std::size_t threads = std::min(thread_count(), tiles.count());
  if (threads < 2 || tiles.count() < W::kWorthThreads) {
    Value prefix = work.identity();
    for (std::size_t t = 0; t < tiles.count(); ++t)
      prefix = scan_tile(tiles, t, std::move(prefix), work);
    end_thread(work);
    return prefix;
  }
  if constexpr (W::kOnePass) {
    if (in_parts) return scan_in_parts(tiles, threads, work);
  }
  return scan_in_relay(tiles, threads, work);
}

}  // namespace relumbre::chained
