/// A cache of one word a line.
///
///                 set = address mod (lines / ways)          tag = the whole address
///
///     set 0     | tag | tag | ... |     ways = 1       direct-mapped
///     set 1     | tag | tag | ... |     ways = lines   fully associative: one set
///      ...        one tag a way
///
/// Only what is asked for matters here, not what is stored: a cache keeps tags and no words. It is
/// cold at first, and a line once filled is never invalidated.
///
/// Source: Hennessy and Patterson, "Computer Architecture", appendix B.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "relumbre/archsim/address_map.h"
#include "relumbre/base/sampling.h"

namespace relumbre {

/// Which word of a full set makes room.
enum class Replacement {
  kLru,     ///< the least recently asked for
  kFifo,    ///< the one that came first
  kRandom,  ///< any: the same ones for the same seed
};

struct CacheConfig {
  std::uint64_t lines = 512;  ///< 1 to kMaxLines
  std::uint64_t ways = 1;     ///< a divisor of `lines`
  Replacement replacement = Replacement::kLru;
  std::uint64_t seed = 1;  ///< of kRandom
  static constexpr std::uint64_t kMaxLines = std::uint64_t{1} << 24;
};

struct CacheCounters {
  std::uint64_t reads = 0;
  std::uint64_t hits = 0;
  std::uint64_t replacements = 0;  ///< misses that threw a word out
  std::uint64_t lines_used = 0;    ///< distinct lines ever filled

  [[nodiscard]] std::uint64_t misses() const { return reads - hits; }
  CacheCounters& operator+=(const CacheCounters& other);
  friend bool operator==(const CacheCounters&, const CacheCounters&) = default;
};

/// What became of one read: found; put into an empty line; put in another word's place.
enum class CacheOutcome { kHit, kFilled, kReplaced };

/// Sets whose ways are searched one after the other: O(ways) a read.
class SearchedSets {
 public:
  explicit SearchedSets(const CacheConfig& config);
  CacheOutcome read(std::uint64_t address);

 private:
  std::size_t ways_;
  std::uint64_t sets_;
  Replacement replacement_;
  RandomStream random_;
  std::vector<std::uint64_t> tags_;  ///< of each set, the last to make room first
  std::vector<std::uint32_t> used_;  ///< ways of each set
};

/// One set that finds its words by a hash and keeps their order in a list: O(1) a read.
class HashedSet {
 public:
  explicit HashedSet(const CacheConfig& config);
  CacheOutcome read(std::uint64_t address);

 private:
  using Line = std::uint32_t;
  struct Entry {
    std::uint64_t address = 0;
    Line newer = 0, older = 0;
  };
  void unlink(Line line);
  void put_first(Line line);
  Line victim();

  std::size_t lines_;
  Replacement replacement_;
  RandomStream random_;
  AddressMap<Line> line_of_;
  std::vector<Entry> entries_;  ///< a ring through entry 0, which is no line: newest to oldest
};

class Cache {
 public:
  /// Throws ValueError for lines or ways out of range.
  explicit Cache(const CacheConfig& config);

  CacheOutcome read(std::uint64_t address);
  [[nodiscard]] const CacheCounters& counters() const { return counters_; }

 private:
  std::variant<SearchedSets, HashedSet> store_;
  CacheCounters counters_;
};

}  // namespace relumbre
