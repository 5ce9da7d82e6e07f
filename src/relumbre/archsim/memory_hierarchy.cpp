#include "relumbre/archsim/memory_hierarchy.h"

#include <algorithm>

namespace relumbre {

namespace {

CacheConfig cache_of(const HierarchyConfig& config, int level) {
  const std::uint64_t lines = lines_of_level(level, config.lines);
  return {.lines = lines,
          .ways = config.ways == 0 ? lines : std::min(config.ways, lines),
          .replacement = config.replacement,
          .seed = hash64(config.seed + static_cast<std::uint64_t>(level))};
}

}  // namespace

MemoryHierarchy::MemoryHierarchy(const HierarchyConfig& config) {
  for (int level = 0; level < config.levels; ++level) {
    const CacheConfig cache = cache_of(config, level);
    caches_.emplace_back(cache);
    if (config.classify) classifiers_.emplace_back(cache.lines);
  }
}

void MemoryHierarchy::read(int level, std::uint64_t address) {
  const auto at = static_cast<std::size_t>(level);
  const CacheOutcome outcome = caches_[at].read(address);
  if (!classifiers_.empty()) classifiers_[at].read(address, outcome);
}

std::vector<CacheCounters> MemoryHierarchy::counters() const {
  std::vector<CacheCounters> all;
  for (const Cache& cache : caches_) all.push_back(cache.counters());
  return all;
}

std::vector<MissClasses> MemoryHierarchy::classes() const {
  std::vector<MissClasses> all;
  for (const MissClassifier& classifier : classifiers_) all.push_back(classifier.classes());
  return all;
}

}  // namespace relumbre
