#include "relumbre/archsim/trace_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/archsim/dinero.h"
#include "relumbre/archsim/simulate.h"
#include "relumbre/archsim/trace_testing.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"

namespace relumbre {
namespace {

using namespace archsim_testing;

// docs/trace.md
constexpr std::size_t kReads = 32, kFileBytes = 40, kTableHash = 48, kHash = 56, kTable = 64;

std::string stored(const Trace& trace) {
  const TemporaryFolder folder;
  write_trace(folder / "a.rlt", trace);
  return read_file(folder / "a.rlt");
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

template <class T>
void put(std::string& file, std::size_t at, T value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

/// As who forges a file would.
void seal(std::string& file, std::size_t bands) {
  put(file, kTableHash, content_hash(bytes_of(file).subspan(kTable, 24 * bands)));
  put(file, kHash, content_hash(bytes_of(file).first(kHash)));
}

std::string error_of(const std::string& file) {
  try {
    (void)parse_trace(bytes_of(file), "t.rlt");
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

void expect_same(const Trace& a, const Trace& b) {
  EXPECT_EQ(a.shape(), b.shape());
  EXPECT_TRUE(std::ranges::equal(a.tasks(), b.tasks()));
  EXPECT_TRUE(std::ranges::equal(a.read_counts(), b.read_counts()));
  EXPECT_TRUE(std::ranges::equal(a.reads(), b.reads()));
}

TEST(TraceFile, BringsBackWhatWasWritten) {
  const TemporaryFolder folder;
  for (const TraceShape& shape : {TraceShape{1, 1, 1}, TraceShape{37, 15, 6}, TraceShape{5, 16, 20},
                                  TraceShape{8, 17, 3}, TraceShape{1, 100, 9}}) {
    const Trace trace = random_trace(shape, 1);
    write_trace(folder / "t.rlt", trace);
    expect_same(read_trace(folder / "t.rlt"), trace);
  }
}

TEST(TraceFile, HoldsAPictureThatReadsNothing) {
  const Trace trace = record({20, 30, 4}, std::vector<RayReads>(600));
  expect_same(parse_trace(bytes_of(stored(trace)), "t"), trace);
}

TEST(TraceFile, IsSmallerThanTheTrace) {
  const Trace trace = random_trace({200, 100, 8}, 2);
  EXPECT_LT(stored(trace).size(), trace.bytes() / 2);
}

TEST(TraceFile, EveryTruncationIsNoticed) {
  const std::string whole = stored(random_trace({9, 33, 5}, 3));
  for (std::size_t size = 0; size < whole.size(); size += size < 200 ? 1 : 37)
    EXPECT_NE(error_of(whole.substr(0, size)), "") << size;
  EXPECT_NE(error_of(whole + '\0'), "");
}

TEST(TraceFile, EveryFlippedBitIsNoticed) {
  const std::string whole = stored(random_trace({9, 33, 5}, 4));
  for (std::size_t at = 0; at < whole.size(); at += at < 200 ? 1 : 29) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1 << at % 8);
    const std::string error = error_of(damaged);
    EXPECT_EQ(error.substr(0, 7), "t.rlt: ") << at;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(TraceFile, ForgedNumbersAreRefused) {
  const std::string whole = stored(random_trace({9, 33, 5}, 5));  // 3 bands
  const auto forged = [&](std::size_t at, auto value) {
    std::string file = whole;
    put(file, at, value);
    seal(file, 3);
    return error_of(file);
  };
  EXPECT_NE(forged(8, 2U).find("version 2"), std::string::npos);
  EXPECT_NE(forged(12, 0x04030201U).find("byte order"), std::string::npos);
  EXPECT_NE(forged(16, 0U).find("0 x 33"), std::string::npos);
  EXPECT_NE(forged(20, 70'000U).find("9 x 70000"), std::string::npos);
  EXPECT_NE(forged(24, 33U).find("33 levels"), std::string::npos);
  EXPECT_NE(forged(24, 4'000'000'000U).find("levels"), std::string::npos);
  EXPECT_NE(forged(24, 4U).find("pixel ("), std::string::npos);  // reads of level 4
  EXPECT_NE(forged(28, 0U), "");
  EXPECT_NE(forged(28, 1U), "");
  EXPECT_NE(forged(28, 17U), "");
  EXPECT_NE(forged(kReads, std::uint64_t{1} << 63).find("allowed"), std::string::npos);
  EXPECT_NE(forged(kReads, std::uint64_t{5}), "");
  EXPECT_NE(forged(kFileBytes, std::uint64_t{5}).find("truncated"), std::string::npos);
  EXPECT_NE(forged(kTable, ~std::uint64_t{0}), "");
  EXPECT_NE(forged(kTable + 8, ~std::uint64_t{0}), "");
  EXPECT_NE(forged(kTable + 16, std::uint64_t{0}).find("band 0"), std::string::npos);
}

TEST(TraceFile, WhatNeedsTooMuchMemoryIsRefusedBeforeItIsAllocated) {
  const Trace trace = random_trace({9, 33, 5}, 6);
  const std::string file = stored(trace);
  const std::uint64_t needed = 8 * 9 * 33 + trace.reads().size();
  EXPECT_NO_THROW(parse_trace(bytes_of(file), "t", needed));
  EXPECT_THROW(parse_trace(bytes_of(file), "t", needed - 1), FileError);
}

TEST(TraceFile, NothingElseIsATrace) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_trace(folder / "missing.rlt"), FileError);
  write_file(folder / "other.rlt", std::string(5000, 'x'));
  EXPECT_THROW(read_trace(folder / "other.rlt"), FileError);
  write_file(folder / "empty.rlt", "");
  EXPECT_THROW(read_trace(folder / "empty.rlt"), FileError);
  EXPECT_THROW(write_trace(folder / "no" / "t.rlt", random_trace({1, 1, 1}, 1)), FileError);
}

/// The misses of a direct-mapped cache that reads Dinero's text with blocks of two bytes.
std::uint64_t dinero_misses(const std::filesystem::path& file, std::uint64_t lines) {
  std::ifstream in(file);
  std::vector<std::uint64_t> tags(lines, ~std::uint64_t{0});
  std::uint64_t misses = 0, address = 0;
  for (int label = 0; in >> std::dec >> label >> std::hex >> address;) {
    EXPECT_EQ(label, 0);
    std::uint64_t& tag = tags[address / 2 % lines];
    misses += tag != address / 2;
    tag = address / 2;
  }
  return misses;
}

TEST(Dinero, ALevelOfAUnitMissesAsOftenAsItsCache) {
  const TemporaryFolder folder;
  const Trace trace = random_trace({45, 31, 7}, 7);
  const Simulation result = simulate(trace, {.gts = 3, .tile = 4, .lines = 64});
  for (std::uint32_t unit = 0; unit < 3; ++unit)
    for (int level = 3; level < 7; ++level) {
      write_dinero(folder / "t.din", trace, {.gts = 3, .unit = unit, .tile = 4, .level = level});
      EXPECT_EQ(dinero_misses(folder / "t.din", 64),
                result.units[unit].levels[static_cast<std::size_t>(level)].misses());
    }
}

TEST(Dinero, WritesEveryReadInOrder) {
  const TemporaryFolder folder;
  const RayReads first{.tasks = 1, .reads = {{0, 1}, {1, 8}, {2, 71}}},
      second{1, {{0, 1}, {1, 15}}};
  write_dinero(folder / "t.din", record({2, 1, 3}, {first, second}));
  EXPECT_EQ(read_file(folder / "t.din"), "0 2\n0 10\n0 8e\n0 2\n0 1e\n");
}

TEST(Dinero, RefusesUnitsAndLevelsThatAreNotThere) {
  const TemporaryFolder folder;
  const Trace trace = random_trace({3, 3, 3}, 8);
  EXPECT_THROW(write_dinero(folder / "t.din", trace, {.gts = 2, .unit = 2}), ValueError);
  EXPECT_THROW(write_dinero(folder / "t.din", trace, {.level = 3}), ValueError);
  EXPECT_THROW(write_dinero(folder / "t.din", trace, {.level = -1}), ValueError);
  EXPECT_THROW(write_dinero(folder / "t.din", trace, {.tile = 0}), ValueError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace relumbre
