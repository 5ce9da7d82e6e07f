/// Scans of long arrays by all threads, in one pass over memory.
///
/// Threads take groups of tiles in order. The prefix of group g, the fold of all before it, becomes
/// known from group to group: whoever has group g folds its tiles, waits for its prefix, makes that
/// of group g + 1 known and only then scans its tiles, which by now are in its cache (cf. Merrill
/// and Garland 2016, whose look-back this is with a window of one). While it scans, it fetches the
/// group that it takes next, so that memory is read and written at all times.
///
/// Who waits for long, because the thread with an earlier group has lost its processor, folds that
/// group itself. So no thread depends on another's progress, except where that one just folds.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/tiles.h"

namespace relumbre::chained {

template <Work W>
class Relay {
 public:
  using Value = ValueOf<W>;

  Relay(const Tiles& tiles, W& work)
      : tiles_(tiles),
        work_(work),
        groups_((tiles.count() + W::kGroup - 1) / W::kGroup),
        prefixes_(groups_ + 1, work.identity()) {}

  /// What one thread does: groups, until there are none.
  void run() {
    std::vector<Value> prefixes;
    for (std::size_t now = next_++, next; now < groups_; now = next) {
      find_prefixes(now, prefixes);
      next = next_++;
      scan(now, prefixes, next);
    }
    end_thread(work_);
  }
  /// When all threads have run.
  [[nodiscard]] const Value& total() const { return prefixes_.back(); }

 private:
  [[nodiscard]] std::size_t first(std::size_t g) const {
    return std::min(tiles_.count(), g * W::kGroup);
  }
  [[nodiscard]] bool is_known(std::size_t g) const {
    return known_.load(std::memory_order_acquire) >= g;
  }

  /// Of a group's tiles and of what comes behind.
  void find_prefixes(std::size_t g, std::vector<Value>& prefixes) {
    const std::vector<FoldOf<W>> folds = fold(g);
    while (!wait_briefly([&] { return is_known(g); })) help(g);
    prefixes.assign(1, prefixes_[g]);
    for (const auto& fold : folds) prefixes.push_back(work_.combine(prefixes.back(), fold));
    // Whoever has the lock may be folding this group, which a scan in place would overwrite.
    const std::lock_guard lock(mutex_);
    if (known_ == g) make_known(g + 1, prefixes.back());
  }
  std::vector<FoldOf<W>> fold(std::size_t g) {
    std::vector<FoldOf<W>> folds;
    folds.reserve(W::kGroup);
    for (std::size_t t = first(g); t < first(g + 1); ++t)
      folds.push_back(fold_tile(tiles_, t, work_));
    return folds;
  }
  /// Takes over the fold that group g waits for.
  void help(std::size_t g) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return std::this_thread::yield();
    const std::size_t before = known_;
    if (before >= g) return;
    Value prefix = prefixes_[before];
    for (const auto& fold : fold(before)) prefix = work_.combine(prefix, fold);
    make_known(before + 1, std::move(prefix));
  }
  /// Only with the lock.
  void make_known(std::size_t g, Value prefix) {
    prefixes_[g] = std::move(prefix);
    known_.store(g, std::memory_order_release);
  }

  void scan(std::size_t g, std::vector<Value>& prefixes, std::size_t next) {
    const std::size_t offset = first(next) - first(g);
    for (std::size_t t = first(g); t < first(g + 1); ++t) {
      const std::size_t begin = tiles_.begin(t), end = tiles_.end(t);
      Value& prefix = prefixes[t - first(g)];
      if constexpr (requires { work_.scan(begin, end, prefix, begin); })
        work_.scan(begin, end, std::move(prefix), std::min(tiles_.size, tiles_.begin(t + offset)));
      else
        work_.scan(begin, end, std::move(prefix));
    }
  }

  Tiles tiles_;
  W& work_;
  std::size_t groups_;
  std::vector<Value> prefixes_;  // of groups; [0, known_] are known
  std::mutex mutex_;             // of who makes the next one known
  alignas(64) std::atomic<std::size_t> known_ = 0;
  alignas(64) std::atomic<std::size_t> next_ = 0;
};

/// Scans all tiles and returns the total.
template <Work W>
ValueOf<W> scan_in_relay(const Tiles& tiles, std::size_t threads, W& work) {
  Relay<W> relay(tiles, work);
  parallel_chunks(0, threads, 1, [&](std::size_t, std::size_t) { relay.run(); });
  return relay.total();
}

}  // namespace relumbre::chained
