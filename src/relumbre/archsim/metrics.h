/// What a simulated picture cost, and what it would have cost two simpler machines.
///
///   proposed        a cache a level and unit         M = Σ misses     2 bytes a word
///   naive word      the same words, no caches        M = reads        2 bytes a word
///   naive pointer   each task that is popped, a      M = tasks        32 bytes a record:
///                   voxel's too, reads its record                     8 pointers of 4 bytes
#pragma once

#include <cstdint>
#include <vector>

#include "relumbre/archsim/cache.h"
#include "relumbre/archsim/miss_classes.h"

namespace relumbre {

inline constexpr std::uint64_t kWordBytes = 2, kRecordBytes = 32;

/// Of one geometry unit, or summed over several.
struct UnitCounters {
  std::uint64_t rays = 0;
  std::uint64_t tasks = 0;            ///< popped
  std::vector<CacheCounters> levels;  ///< level 0 first; empty for a unit without pixels
  std::vector<MissClasses> classes;   ///< as `levels`, or empty where nobody asked for them

  /// Throws ShapeError for another number of levels, other than none.
  UnitCounters& operator+=(const UnitCounters& other);
  friend bool operator==(const UnitCounters&, const UnitCounters&) = default;
};

struct SystemMetrics {
  std::uint64_t fetches = 0;  ///< M: words, or records, read from the memory of the objects
  std::uint64_t bytes = 0;
  double hit_rate = 0;  ///< L = Σ hits / Σ reads; 0 where there are no reads or no caches
};

struct MachineMetrics {
  std::uint64_t reads = 0;  ///< words asked for
  std::uint64_t tasks = 0;
  SystemMetrics proposed, naive_word, naive_pointer;
};

/// Of all units together. Sums over units and levels, not means of rates.
MachineMetrics metrics_of(const UnitCounters& total);

/// hits / reads, or 0 where nothing is read.
double hit_rate(std::uint64_t hits, std::uint64_t reads);
double hit_rate(const CacheCounters& counters);

}  // namespace relumbre
