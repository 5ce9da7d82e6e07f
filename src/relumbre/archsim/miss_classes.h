/// Why a cache misses: the three Cs.
///
///   compulsory   the cache never had the word: no cache could have hit
///   capacity     of the others: a fully associative LRU cache of as many lines misses, too
///   conflict     the rest: only the mapping of addresses to sets is to blame
///
/// Source: Hill and Smith 1989.
#pragma once

#include <cstdint>

#include "relumbre/archsim/address_map.h"
#include "relumbre/archsim/cache.h"

namespace relumbre {

struct MissClasses {
  std::uint64_t compulsory = 0, capacity = 0, conflict = 0;

  [[nodiscard]] std::uint64_t sum() const { return compulsory + capacity + conflict; }
  MissClasses& operator+=(const MissClasses& other) {
    compulsory += other.compulsory;
    capacity += other.capacity;
    conflict += other.conflict;
    return *this;
  }
  friend bool operator==(const MissClasses&, const MissClasses&) = default;
};

/// Runs beside one cache and is told of all its reads, in order. O(1) a read; 32 to 64 bytes a
/// distinct address, and as many and 16 more a line that is used.
class MissClassifier {
 public:
  explicit MissClassifier(std::uint64_t lines) : associative_({.lines = lines, .ways = lines}) {}

  void read(std::uint64_t address, CacheOutcome outcome) {
    const bool is_first = touched_.insert(address, true).second;
    const bool would_hit = associative_.read(address) == CacheOutcome::kHit;
    if (outcome == CacheOutcome::kHit) return;
    ++(is_first ? classes_.compulsory : would_hit ? classes_.conflict : classes_.capacity);
  }
  [[nodiscard]] const MissClasses& classes() const { return classes_; }

 private:
  Cache associative_;
  AddressMap<bool> touched_;
  MissClasses classes_;
};

}  // namespace relumbre
