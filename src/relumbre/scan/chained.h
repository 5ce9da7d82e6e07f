/// Scans over tiles by all threads, in one pass over memory.
///
/// Threads take groups of tiles in order. A group's prefix, the fold of all before it, is handed
/// from group to group: whoever has group g folds its tiles, waits for its turn, leaves the prefix
/// of group g + 1 to the next and only then scans its tiles, which by now are in its cache (cf.
/// Merrill and Garland 2016, whose look-back this is with a window of one). A thread that waits
/// holds a later group than one that is being worked on, so there is no deadlock however few
/// threads there are.
///
/// Tiles depend on the size only, and the prefixes of tiles are folded one after another whatever
/// the groups, so that results have the same bits for any number of threads. The operation itself
/// must not run a parallel loop.
#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <thread>
#include <utility>
#include <vector>

#include "relumbre/base/parallel.h"

namespace relumbre::chained {

/// What a scan does with its elements.
///   identity()                  the first tile's prefix
///   fold(first, last)           of elements [first, last), not necessarily a prefix itself
///   combine(prefix, fold)       the prefix of what comes behind
///   scan(first, last, prefix)   writes results; returns the same
///   kOnePass                    whether it has the same bits, too
///   kWorthThreads               how many tiles are worth a second thread
template <class W>
concept Work = requires(W& w, std::size_t i) {
  { W::kOnePass } -> std::convertible_to<bool>;
  { W::kWorthThreads } -> std::convertible_to<std::size_t>;
  w.combine(w.identity(), w.fold(i, i));
  w.scan(i, i, w.identity());
};

template <class W>
using ValueOf = decltype(std::declval<W&>().identity());

/// A prefix, and the group whose it is.
template <class Value>
class Chain {
 public:
  explicit Chain(Value first) : prefix_(std::move(first)) {}
  [[nodiscard]] bool is_turn(std::size_t group) const {
    return turn_.load(std::memory_order_acquire) == group;
  }
  /// Returns at the group's turn; false if there will be none.
  [[nodiscard]] bool wait(std::size_t group) const {
    constexpr int kSpins = 4096;  // some microseconds: a fold takes no longer
    for (int spin = 0; !is_turn(group); ++spin) {
      if (abandoned_.load(std::memory_order_relaxed)) return false;
      if (spin > kSpins) std::this_thread::yield();
    }
    return true;
  }
  /// Only at one's turn.
  [[nodiscard]] const Value& prefix() const { return prefix_; }
  /// Only at one's turn, and ends it.
  void pass_on(std::size_t group, Value next) {
    prefix_ = std::move(next);
    turn_.store(group + 1, std::memory_order_release);
  }
  void abandon() { abandoned_.store(true, std::memory_order_relaxed); }

 private:
  alignas(64) std::atomic<std::size_t> turn_ = 0;
  Value prefix_;
  std::atomic<bool> abandoned_ = false;
};

/// Elements in tiles, tiles in groups.
struct Tiles {
  std::size_t size, tile, group = 1;
  [[nodiscard]] std::size_t count() const { return (size + tile - 1) / tile; }
  [[nodiscard]] std::size_t groups() const { return (count() + group - 1) / group; }
  [[nodiscard]] std::size_t begin(std::size_t t) const { return t * tile; }
  [[nodiscard]] std::size_t end(std::size_t t) const {
    return size - t * tile < tile ? size : (t + 1) * tile;
  }
};

/// Scans tiles [first, last) behind `prefix`; returns the prefix of what comes behind.
template <Work W, class Value = ValueOf<W>>
Value scan_run(const Tiles& tiles, std::size_t first, std::size_t last, Value prefix, W& work) {
  for (std::size_t t = first; t < last; ++t) {
    const std::size_t begin = tiles.begin(t), end = tiles.end(t);
    // Behind the first tile and the last there is one way only to fold.
    if (W::kOnePass || t == 0 || t + 1 == tiles.count()) {
      prefix = work.scan(begin, end, prefix);
    } else {
      Value next = work.combine(prefix, work.fold(begin, end));
      work.scan(begin, end, std::move(prefix));
      prefix = std::move(next);
    }
  }
  return prefix;
}

/// False if the chain was abandoned.
template <Work W, class Value = ValueOf<W>>
bool scan_group(const Tiles& tiles, std::size_t g, Chain<Value>& chain, W& work) {
  const std::size_t first = g * tiles.group, last = std::min(first + tiles.group, tiles.count());
  if (last == tiles.count()) {  // no one waits for its fold
    if (!chain.wait(g)) return false;
    chain.pass_on(g, scan_run(tiles, first, last, chain.prefix(), work));
    return true;
  }
  using Fold = decltype(work.fold(0, 0));
  std::vector<Fold> folds;
  folds.reserve(last - first);
  for (std::size_t t = first; t < last; ++t)
    folds.push_back(work.fold(tiles.begin(t), tiles.end(t)));
  if (!chain.wait(g)) return false;
  std::vector<Value> prefixes{chain.prefix()};
  prefixes.reserve(folds.size() + 1);
  for (const Fold& fold : folds) prefixes.push_back(work.combine(prefixes.back(), fold));
  chain.pass_on(g, std::move(prefixes.back()));
  for (std::size_t t = first; t < last; ++t)
    work.scan(tiles.begin(t), tiles.end(t), std::move(prefixes[t - first]));
  return true;
}

/// Takes groups until there are none.
template <Work W, class Value = ValueOf<W>>
void scan_groups(const Tiles& tiles, std::atomic<std::size_t>& next, Chain<Value>& chain, W& work) {
  try {
    for (std::size_t g = next++; g < tiles.groups(); g = next++) {
      if (!scan_group(tiles, g, chain, work)) return;
    }
  } catch (...) {
    chain.abandon();
    throw;
  }
}

/// Scans `tiles` and returns the total. `in_cache`: they all stay in the caches from one scan to
/// the next. Every thread then has one group only, and finds its part in its own cache.
template <Work W, class Value = ValueOf<W>>
Value scan_tiles(Tiles tiles, bool in_cache, W& work) {
  const std::size_t threads = std::min(thread_count(), tiles.count());
  if (threads < 2 || tiles.count() < W::kWorthThreads)
    return scan_run(tiles, 0, tiles.count(), work.identity(), work);
  if (in_cache) tiles.group = (tiles.count() + threads - 1) / threads;
  Chain<Value> chain(work.identity());
  alignas(64) std::atomic<std::size_t> next = 0;
  parallel_chunks(0, threads, 1,
                  [&](std::size_t, std::size_t) { scan_groups(tiles, next, chain, work); });
  return chain.prefix();
}

}  // namespace relumbre::chained
