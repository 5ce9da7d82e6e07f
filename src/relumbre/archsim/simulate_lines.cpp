#include <algorithm>
#include <bit>
#include <vector>

#include <fmt/format.h>

#include "relumbre/archsim/replay.h"
#include "relumbre/archsim/simulate.h"
#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

/// The direct-mapped caches of one level, of growing size; those that would be larger than the
/// level are left out, since the last one that is not cannot conflict.
template <class Tag>
class CacheChain {
 public:
  CacheChain(int level, std::span<const std::uint64_t> sorted_lines) {
    const std::uint64_t addresses = std::uint64_t{1} << 3 * level;
    for (const std::uint64_t lines : sorted_lines) {
      caches_.push_back({.mask = std::min(lines_of_level(level, lines), addresses) - 1});
      if (caches_.back().mask + 1 == addresses) break;
    }
    std::uint64_t size = 0;
    for (const auto& cache : caches_) size += cache.mask + 1;
    tags_ = HugeArray<Tag>(size);
    std::ranges::fill(tags_.span(), Tag{0});  // no address is 0
    Tag* at = tags_.data();
    for (auto& cache : caches_) cache.tags = std::exchange(at, at + cache.mask + 1);
    smallest_ = caches_[0];
  }

  void read(Tag address) {
    ++reads_;
    Tag& tag = smallest_.tags[address & smallest_.mask];
    if (tag == address) return;
    miss(tag, address);
  }

  /// Of the k-th cache.
  [[nodiscard]] CacheCounters counters(std::size_t k) const {
    const auto& cache = caches_[std::min(k, caches_.size() - 1)];
    return {reads_, reads_ - cache.replacements - cache.lines_used, cache.replacements,
            cache.lines_used};
  }

 private:
  struct DirectMapped {
    std::uint64_t mask = 0;
    Tag* tags = nullptr;
    std::uint64_t replacements = 0, lines_used = 0;

    /// Puts the address where `tag` was.
    void fill(Tag& tag, Tag address) {
      ++(tag == 0 ? lines_used : replacements);
      tag = address;
    }
  };

  [[gnu::noinline]] void miss(Tag& smallest_tag, Tag address) {
    caches_[0].fill(smallest_tag, address);
    for (std::size_t k = 1; k < caches_.size(); ++k) {
      Tag& tag = caches_[k].tags[address & caches_[k].mask];
      if (tag == address) return;
      caches_[k].fill(tag, address);
    }
  }

  DirectMapped smallest_;  ///< a copy of the first one's place
  std::uint64_t reads_ = 0;
  std::vector<DirectMapped> caches_;
  HugeArray<Tag> tags_;
};

/// One unit, all sizes; `sorted_lines` ascending. The counters of each size.
template <class Tag>
std::vector<UnitCounters> simulate_unit(const Trace& trace, const Tiles& tiles, std::uint32_t unit,
                                        std::span<const std::uint64_t> sorted_lines) {
  if (tiles.owned_by(unit).is_empty()) return std::vector<UnitCounters>(sorted_lines.size());
  std::vector<CacheChain<Tag>> levels;
  for (int level = 0; level < trace.shape().levels; ++level)
    levels.emplace_back(level, sorted_lines);
  UnitCounters work;
  PathDecoder<Tag> decode;
  replay(trace, tiles, unit, [&](const TraceRun& run) {
    work.rays += run.rays;
    work.tasks += run.tasks;
    CacheChain<Tag>* const chains = levels.data();
    for (const std::uint8_t byte : run.reads) {
      const auto read = decode(byte);
      chains[read.level].read(read.address);
    }
  });
  std::vector<UnitCounters> all(sorted_lines.size(), work);
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const auto& level : levels) all[k].levels.push_back(level.counters(k));
  return all;
}

void check(const MachineConfig& config, std::span<const std::uint64_t> lines) {
  if (config.ways != 1 || config.classify)
    throw ValueError(
        "caches that are not direct-mapped, or whose misses are to be classified, "
        "need a pass for each size");
  for (const std::uint64_t size : lines)
    if (!std::has_single_bit(size) || size > CacheConfig::kMaxLines)
      throw ValueError(fmt::format("caches of {} lines: that must be a power of two up to {}", size,
                                   CacheConfig::kMaxLines));
}

}  // namespace

std::vector<Simulation> simulate_lines(const Trace& trace, const MachineConfig& config,
                                       std::span<const std::uint64_t> lines) {
  check(config, lines);
  const Tiles tiles(trace.shape().width, trace.shape().height, config.tile, config.gts);
  std::vector<std::uint64_t> sorted(lines.begin(), lines.end());
  std::ranges::sort(sorted);
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.empty()) return {};

  const bool fits = trace.shape().levels <= 11;              // 31 bits an address
  std::vector<std::vector<UnitCounters>> units(config.gts);  // [unit][size]
  parallel_for(0, units.size(), 1, [&](std::size_t i) {
    const auto unit = static_cast<std::uint32_t>(i);
    units[i] = fits ? simulate_unit<std::uint32_t>(trace, tiles, unit, sorted)
                    : simulate_unit<std::uint64_t>(trace, tiles, unit, sorted);
  });

  std::vector<Simulation> results(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto k =
        static_cast<std::size_t>(std::ranges::lower_bound(sorted, lines[i]) - sorted.begin());
    for (const auto& unit : units) results[i].units.push_back(unit[k]);
    for (const UnitCounters& unit : results[i].units) results[i].total += unit;
  }
  return results;
}

}  // namespace relumbre
