/// Scans of arrays that stay in the caches, in as many parts as there are threads, so that a thread
/// finds its part in its own cache the next time.
///
/// The first part's prefix is known, and its thread scans at once. Every other thread folds the
/// tiles of the part before its own, last one first, until it meets the tile whose prefix the other
/// thread has come to; that prefix and the folds make its own. So it matters little if a thread
/// comes late. Parts are taken in order, and a thread waits for earlier parts only: there is no
/// deadlock however few threads there are.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/tiles.h"

namespace relumbre::chained {

/// Tiles [first, last), and the prefixes of those that its thread has come to.
template <class Value>
class Part {
 public:
  void assign(std::size_t first, std::size_t last) {
    first_ = first, last_ = last;
    prefixes_.reserve(last - first + 1);
  }
  [[nodiscard]] std::size_t first() const { return first_; }
  [[nodiscard]] std::size_t last() const { return last_; }

  /// By the part's own thread: the prefix of its next tile, or at the end of what comes behind.
  void add(Value prefix) {
    prefixes_.push_back(std::move(prefix));
    known_.store(prefixes_.size(), std::memory_order_release);
  }
  [[nodiscard]] bool knows(std::size_t t) const {
    return known_.load(std::memory_order_acquire) > t - first_;
  }
  /// Only if it knows.
  [[nodiscard]] const Value& prefix(std::size_t t) const { return prefixes_.data()[t - first_]; }

 private:
  std::size_t first_ = 0, last_ = 0;
  std::vector<Value> prefixes_;
  alignas(64) std::atomic<std::size_t> known_ = 0;
};

template <Work W>
requires W::kOnePass class Parts {
 public:
  using Value = ValueOf<W>;

  Parts(const Tiles& tiles, std::size_t count, W& work)
      : tiles_(tiles), work_(work), count_(count), parts_(new Part<Value>[count]) {
    // The first part is 5/3 of the others: a fold takes half a scan's time, and threads come late.
    const std::size_t shares = 3 * count + 2;
    for (std::size_t p = 0; p < count; ++p)
      parts_[p].assign(p == 0 ? 0 : parts_[p - 1].last(), (3 * p + 5) * tiles.count() / shares);
  }

  /// What one thread does: parts, until there are none.
  void run() {
    try {
      for (std::size_t p = next_++; p < count_; p = next_++) {
        if (!find_prefix(p)) return;
        scan(parts_[p]);
      }
      end_thread(work_);
    } catch (...) {
      abandoned_.store(true, std::memory_order_relaxed);
      throw;
    }
  }
  /// When all threads have run.
  [[nodiscard]] const Value& total() const {
    return parts_[count_ - 1].prefix(parts_[count_ - 1].last());
  }

 private:
  /// False if there will be none.
  bool find_prefix(std::size_t p) {
    if (p == 0) return parts_[0].add(work_.identity()), true;
    const Part<Value>& before = parts_[p - 1];
    std::size_t t = before.last();
    std::vector<FoldOf<W>> folds;  // of tiles from t on, last one first
    while (t > before.first() && !before.knows(t)) folds.push_back(fold_tile(tiles_, --t, work_));
    wait_until([&] { return before.knows(t) || abandoned_.load(std::memory_order_relaxed); });
    if (!before.knows(t)) return false;
    Value prefix = before.prefix(t);
    for (; !folds.empty(); folds.pop_back()) prefix = work_.combine(prefix, folds.back());
    parts_[p].add(std::move(prefix));
    return true;
  }
  void scan(Part<Value>& part) {
    for (std::size_t t = part.first(); t < part.last(); ++t)
      part.add(scan_tile(tiles_, t, part.prefix(t), work_));
  }

  Tiles tiles_;
  W& work_;
  std::size_t count_;
  std::unique_ptr<Part<Value>[]> parts_;
  alignas(64) std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> abandoned_ = false;
};

/// Scans all tiles and returns the total.
template <Work W>
ValueOf<W> scan_in_parts(const Tiles& tiles, std::size_t threads, W& work) {
  Parts<W> parts(tiles, threads, work);
  parallel_chunks(0, threads, 1, [&](std::size_t, std::size_t) { parts.run(); });
  return parts.total();
}

}  // namespace relumbre::chained
