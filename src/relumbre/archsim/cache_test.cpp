#include "relumbre/archsim/cache.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/archsim/memory_hierarchy.h"
#include "relumbre/base/error.h"

namespace relumbre {
namespace {

using enum CacheOutcome;

std::vector<CacheOutcome> outcomes(const CacheConfig& config,
                                   const std::vector<std::uint64_t>& addresses) {
  Cache cache(config);
  std::vector<CacheOutcome> all;
  for (const std::uint64_t address : addresses) all.push_back(cache.read(address));
  return all;
}

/// A list a set, newest first, searched from the start.
class SlowCache {
 public:
  explicit SlowCache(const CacheConfig& config) : config_(config) {}
  CacheOutcome read(std::uint64_t address) {
    auto& set = sets_[address % (config_.lines / config_.ways)];
    const auto at = std::ranges::find(set, address);
    if (at != set.end()) {
      if (config_.replacement != Replacement::kLru) return kHit;
      set.erase(at);
      set.insert(set.begin(), address);
      return kHit;
    }
    set.insert(set.begin(), address);
    if (set.size() <= config_.ways) return kFilled;
    set.pop_back();
    return kReplaced;
  }

 private:
  CacheConfig config_;
  std::map<std::uint64_t, std::vector<std::uint64_t>> sets_;
};

/// Mostly near to the one before.
std::vector<std::uint64_t> random_addresses(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<std::uint64_t> all(count);
  std::uint64_t at = 0;
  for (auto& address : all) {
    at = random.bits() % 16 == 0 ? random.bits() : at + random.bits() % 64 - 31;
    address = at % 1021;
  }
  return all;
}

TEST(Cache, ConflictMissEvicts) {
  EXPECT_EQ(outcomes({.lines = 8}, {1, 9, 1, 9, 2, 2}),
            (std::vector{kFilled, kReplaced, kReplaced, kReplaced, kFilled, kHit}));
}

TEST(Cache, TwoWaysHoldTwoAddressesOfASet) {
  EXPECT_EQ(outcomes({.lines = 8, .ways = 2}, {1, 5, 1, 5, 9, 5}),
            (std::vector{kFilled, kFilled, kHit, kHit, kReplaced, kHit}));
}

TEST(Cache, LruKeepsWhatWasAskedForLastFifoWhatCameLast) {
  const std::vector<std::uint64_t> addresses{1, 2, 1, 3, 1, 2};
  CacheConfig config{.lines = 2, .ways = 2, .replacement = Replacement::kLru};
  EXPECT_EQ(outcomes(config, addresses),
            (std::vector{kFilled, kFilled, kHit, kReplaced, kHit, kReplaced}));
  config.replacement = Replacement::kFifo;
  EXPECT_EQ(outcomes(config, addresses),
            (std::vector{kFilled, kFilled, kHit, kReplaced, kReplaced, kReplaced}));
}

TEST(Cache, AnyShapeDoesWhatASlowOneDoes) {
  const auto addresses = random_addresses(20'000, 1);
  for (const Replacement replacement : {Replacement::kLru, Replacement::kFifo})
    for (const auto& [lines, ways] :
         std::map<std::uint64_t, std::vector<std::uint64_t>>{{1, {1}},
                                                             {7, {1, 7}},
                                                             {12, {1, 2, 3, 4, 6, 12}},
                                                             {256, {1, 2, 8, 64, 256}},
                                                             {2000, {2000}}})
      for (const std::uint64_t way : ways) {
        const CacheConfig config{.lines = lines, .ways = way, .replacement = replacement};
        Cache cache(config);
        SlowCache slow(config);
        for (const std::uint64_t address : addresses)
          ASSERT_EQ(cache.read(address), slow.read(address)) << lines << " lines, " << way;
      }
}

TEST(Cache, CountersAddUp) {
  const auto addresses = random_addresses(5'000, 2);
  const std::size_t distinct = std::set(addresses.begin(), addresses.end()).size();
  for (const Replacement replacement :
       {Replacement::kLru, Replacement::kFifo, Replacement::kRandom})
    for (const std::uint64_t ways : {1U, 4U, 64U}) {
      Cache cache({.lines = 64, .ways = ways, .replacement = replacement});
      for (const std::uint64_t address : addresses) cache.read(address);
      const CacheCounters& counters = cache.counters();
      EXPECT_EQ(counters.reads, addresses.size());
      EXPECT_EQ(counters.misses(), counters.replacements + counters.lines_used);
      EXPECT_LE(counters.lines_used, 64U);
      EXPECT_GE(counters.misses(), distinct);
    }
}

TEST(Cache, LargeEnoughMissesOnlyFirstTouches) {
  const auto addresses = random_addresses(5'000, 3);
  const std::size_t distinct = std::set(addresses.begin(), addresses.end()).size();
  for (const Replacement replacement :
       {Replacement::kLru, Replacement::kFifo, Replacement::kRandom})
    for (const std::uint64_t ways : {1U, 2U, 1024U}) {
      Cache cache({.lines = 1024, .ways = ways, .replacement = replacement});
      for (const std::uint64_t address : addresses) cache.read(address);
      EXPECT_EQ(cache.counters().misses(), distinct);
      EXPECT_EQ(cache.counters().replacements, 0U);
    }
}

TEST(Cache, RandomReplacementFollowsItsSeed) {
  const auto addresses = random_addresses(5'000, 4);
  for (const std::uint64_t ways : {8U, 64U}) {
    CacheConfig config{.lines = 64, .ways = ways, .replacement = Replacement::kRandom, .seed = 1};
    const auto first = outcomes(config, addresses);
    EXPECT_EQ(first, outcomes(config, addresses));
    config.seed = 2;
    EXPECT_NE(first, outcomes(config, addresses));
  }
}

TEST(Cache, TheWholeAddressIsTheTag) {
  // Tags that were cut short took these for the same word.
  const std::uint64_t far = std::uint64_t{1} << 57;
  EXPECT_EQ(outcomes({.lines = 512}, {far, far + 512, far, far}),
            (std::vector{kFilled, kReplaced, kReplaced, kHit}));
  EXPECT_EQ(outcomes({.lines = 4, .ways = 4}, {0, ~std::uint64_t{0}, far, 0, ~std::uint64_t{0}}),
            (std::vector{kFilled, kFilled, kFilled, kHit, kHit}));
}

TEST(Cache, EveryLineIsUsed) {
  // An index field that was too narrow used 128 of them.
  Cache cache({.lines = 262'144});
  for (std::uint64_t address = 0; address < 262'144; ++address) cache.read(262'144 + address);
  EXPECT_EQ(cache.counters().lines_used, 262'144U);
  EXPECT_EQ(cache.counters().replacements, 0U);
}

TEST(Cache, RefusesWhatCannotBe) {
  EXPECT_THROW(Cache({.lines = 0}), ValueError);
  EXPECT_THROW(Cache({.lines = CacheConfig::kMaxLines + 1}), ValueError);
  EXPECT_THROW(Cache({.lines = 8, .ways = 0}), ValueError);
  EXPECT_THROW(Cache({.lines = 8, .ways = 3}), ValueError);
  EXPECT_THROW(Cache({.lines = 8, .ways = 16}), ValueError);
}

TEST(AddressMap, DoesWhatTheStandardOneDoes) {
  AddressMap<int> map;
  std::unordered_map<std::uint64_t, int> expected;
  RandomStream random(5);
  for (int i = 0; i < 50'000; ++i) {
    const std::uint64_t address = random.bits() % 700 << (random.bits() % 2 == 0 ? 0 : 50);
    if (random.bits() % 3 == 0) {
      map.erase(address);
      expected.erase(address);
    } else {
      EXPECT_EQ(map.insert(address, i).second, expected.emplace(address, i).second);
    }
    ASSERT_EQ(map.size(), expected.size());
  }
  for (std::uint64_t address = 0; address < 700; ++address) {
    const int* found = map.find(address);
    ASSERT_EQ(found != nullptr, expected.contains(address));
    if (found != nullptr) {
      EXPECT_EQ(*found, expected[address]);
    }
  }
}

TEST(MissClasses, NameTheReason) {
  MemoryHierarchy memory({.levels = 4, .lines = 2, .classify = true});
  // Level 3 has two lines: even and odd addresses. 512 first, 514 in its place; back again: two
  // lines in any place would have kept both. 516 and 518 between: two lines would not.
  for (const std::uint64_t address : {512U, 514U, 512U, 514U, 516U, 518U, 514U})
    memory.read(3, address);
  EXPECT_EQ(memory.classes()[3], (MissClasses{4, 1, 2}));
  EXPECT_EQ(memory.counters()[3].misses(), 7U);
}

TEST(MissClasses, FullyAssociativeLruHasNoConflicts) {
  MemoryHierarchy memory({.levels = 4, .lines = 32, .ways = 0, .classify = true});
  for (const std::uint64_t address : random_addresses(5'000, 6)) memory.read(3, address);
  const MissClasses classes = memory.classes()[3];
  EXPECT_EQ(classes.conflict, 0U);
  EXPECT_GT(classes.capacity, 0U);
  EXPECT_EQ(classes.sum(), memory.counters()[3].misses());
}

TEST(MemoryHierarchy, HasTheLinesOfTheDefinition) {
  MemoryHierarchy memory({.levels = 6, .lines = 16});
  const std::uint64_t lines[] = {8, 64, 512, 16, 16, 16};
  for (int level = 0; level < 6; ++level)
    for (std::uint64_t address = 0; address < 1000; ++address) memory.read(level, address);
  for (std::size_t level = 0; level < 6; ++level)
    EXPECT_EQ(memory.counters()[level].lines_used, lines[level]) << level;
}

TEST(MemoryHierarchy, CachesAreDifferentRandomOnes) {
  MemoryHierarchy memory(
      {.levels = 5, .lines = 64, .ways = 0, .replacement = Replacement::kRandom});
  for (const std::uint64_t address : random_addresses(20'000, 7))
    memory.read(3, address), memory.read(4, address);
  EXPECT_NE(memory.counters()[3], memory.counters()[4]);
}

}  // namespace
}  // namespace relumbre
