/// Elements in tiles, and what a scan does with them.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <thread>
#include <utility>

namespace relumbre::chained {

/// What a scan does with its elements.
///   identity()                  the first tile's prefix
///   fold(first, last)           of elements [first, last), not necessarily a prefix itself
///   combine(prefix, fold)       the prefix of what comes behind
///   scan(first, last, prefix)   writes results; returns the same
///   kOnePass                    whether it has the same bits, too
///   kWorthThreads               how many tiles are worth a second thread
///   kGroup                      how many a thread takes at once: two groups fit its cache
/// and, optionally,
///   scan(first, last, prefix, ahead)   fetches as many elements from `ahead` on into its cache
///   end_thread()                       all that a thread wrote may be read by others
template <class W>
concept Work = requires(W& w, std::size_t i) {
  { W::kOnePass } -> std::convertible_to<bool>;
  { W::kWorthThreads } -> std::convertible_to<std::size_t>;
  { W::kGroup } -> std::convertible_to<std::size_t>;
  w.combine(w.identity(), w.fold(i, i));
  w.scan(i, i, w.identity());
};

template <class W>
using ValueOf = decltype(std::declval<W&>().identity());
template <class W>
using FoldOf = decltype(std::declval<W&>().fold(0, 0));

struct Tiles {
  std::size_t size, tile;
  [[nodiscard]] std::size_t count() const { return (size + tile - 1) / tile; }
  [[nodiscard]] std::size_t begin(std::size_t t) const { return t * tile; }
  [[nodiscard]] std::size_t end(std::size_t t) const {
    return size - t * tile < tile ? size : (t + 1) * tile;
  }
};

template <Work W>
FoldOf<W> fold_tile(const Tiles& tiles, std::size_t t, W& work) {
  return work.fold(tiles.begin(t), tiles.end(t));
}

/// Scans tile t behind `prefix`; returns the prefix of what comes behind.
template <Work W, class Value = ValueOf<W>>
Value scan_tile(const Tiles& tiles, std::size_t t, Value prefix, W& work) {
  const std::size_t begin = tiles.begin(t), end = tiles.end(t);
  // Behind the first tile and the last there is one way only to fold.
  if (W::kOnePass || t == 0 || t + 1 == tiles.count())
    return work.scan(begin, end, std::move(prefix));
  Value next = work.combine(prefix, work.fold(begin, end));
  work.scan(begin, end, std::move(prefix));
  return next;
}

template <Work W>
void end_thread(W& work) {
  if constexpr (requires { work.end_thread(); }) work.end_thread();
}

/// Waits for `ready()` for some microseconds, about as long as a fold takes; returns whether it is.
template <class Ready>
bool wait_briefly(const Ready& ready) {
  constexpr int kSpins = 1 << 14;
  for (int spin = 0; spin < kSpins; ++spin) {
    if (ready()) return true;
  }
  return ready();
}

/// Waits for `ready()`: a short while on the processor, then between other threads' turns.
template <class Ready>
void wait_until(const Ready& ready) {
  while (!wait_briefly(ready)) std::this_thread::yield();
}

}  // namespace relumbre::chained
