/// The caches of one geometry unit (GT), one a level of the tree that the addresses form.
///
///   level      0   1    2   3   4  ...
///   lines      8  64  512   L   L  ...      no cache serves two levels, none backs another
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/archsim/cache.h"
#include "relumbre/archsim/miss_classes.h"

namespace relumbre {

/// Lines of the caches that L does not change.
inline constexpr std::array<std::uint64_t, 3> kUpperLines{8, 64, 512};

/// Of a level's cache.
inline std::uint64_t lines_of_level(int level, std::uint64_t deep_lines) {
  const auto at = static_cast<std::size_t>(level);
  return at < kUpperLines.size() ? kUpperLines[at] : deep_lines;
}

struct HierarchyConfig {
  int levels = 1;
  std::uint64_t lines = 4096;  ///< L
  /// Of every level's cache, or all of its lines where it has fewer; 0: fully associative.
  std::uint64_t ways = 1;
  Replacement replacement = Replacement::kLru;
  std::uint64_t seed = 1;  ///< of Replacement::kRandom
  bool classify = false;   ///< find out why it misses: two to three times the work
};

class MemoryHierarchy {
 public:
  /// Throws ValueError where one of the caches cannot be.
  explicit MemoryHierarchy(const HierarchyConfig& config);

  /// The word at `address`, of a level of 0 to levels-1.
  void read(int level, std::uint64_t address);

  /// By level.
  [[nodiscard]] std::vector<CacheCounters> counters() const;
  /// By level; empty without `classify`.
  [[nodiscard]] std::vector<MissClasses> classes() const;

 private:
  std::vector<Cache> caches_;
  std::vector<MissClassifier> classifiers_;
};

}  // namespace relumbre
