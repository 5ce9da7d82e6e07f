#include "relumbre/scan/compact.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/expand.h"
#include "relumbre/scan/scan_testing.h"

namespace relumbre {
namespace {

using scan_testing::random_values;
using scan_testing::sizes_around;

TEST(Compact, KeepsInOrderWhatCopyIfKeeps) {
  const auto keep = [](int v) { return v % 3 == 0; };
  for (const std::size_t size : sizes_around(scan_detail::kTile<int>)) {
    const auto in = random_values<int>(size, 0, 1000);
    std::vector<int> expected;
    std::copy_if(in.begin(), in.end(), std::back_inserter(expected), keep);
    for (const std::size_t threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      std::vector<int> out(size, -1);
      ASSERT_EQ(compact(in, out, keep), expected.size());
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), out.begin()));
      EXPECT_EQ(std::count(out.begin(), out.end(), -1),
                static_cast<std::ptrdiff_t>(size - expected.size()));
    }
  }
}

TEST(Compact, AllOrNone) {
  const auto in = random_values<int>(40'000, 0, 9);
  std::vector<int> out(in.size(), -1);
  EXPECT_EQ(compact(in, out, [](int) { return false; }), 0U);
  EXPECT_EQ(std::count(out.begin(), out.end(), -1), 40'000);
  EXPECT_EQ(compact(in, out, [](int) { return true; }), in.size());
  EXPECT_EQ(out, in);
}

TEST(Partition, IsStable) {
  const auto is_first = [](std::uint64_t v) { return v % 5 < 2; };
  for (const std::size_t size : sizes_around(scan_detail::kTile<std::uint64_t>)) {
    const auto in = random_values<std::uint64_t>(size, 0, 1'000'000);
    std::vector<std::uint64_t> expected = in;
    const auto middle = std::stable_partition(expected.begin(), expected.end(), is_first);
    for (const std::size_t threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      std::vector<std::uint64_t> out(size);
      EXPECT_EQ(partition(in, out, is_first), static_cast<std::size_t>(middle - expected.begin()));
      EXPECT_EQ(out, expected);
    }
  }
}

TEST(Compact, BadArraysAreRefused) {
  std::vector<int> in(8), out(7);
  const auto all = [](int) { return true; };
  EXPECT_THROW(compact(in, out, all), ShapeError);
  EXPECT_THROW(compact(in, in, all), ValueError);
  EXPECT_THROW(partition(in, out, all), ShapeError);
  EXPECT_THROW(partition(in, in, all), ValueError);
}

TEST(Expand, EveryOwnerGetsWhatItCounts) {
  for (const std::size_t size : {0UL, 1UL, 2UL, 1000UL, 40'000UL}) {
    auto counts = random_values<std::uint16_t>(size, 0, 5);
    if (size > 2) counts[size / 2] = 50'000;  // one that spans several chunks
    std::vector<std::uint32_t> expected_offsets{0}, expected;
    for (std::uint32_t i = 0; i < size; ++i) {
      expected_offsets.push_back(expected_offsets.back() + counts[i]);
      expected.insert(expected.end(), counts[i], i);
    }
    for (const std::size_t threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      std::vector<std::uint32_t> offsets(size + 1), owners(expected.size());
      EXPECT_EQ(offsets_from_counts(counts, offsets), expected.size());
      EXPECT_EQ(offsets, expected_offsets);
      expand(offsets, owners);
      EXPECT_EQ(owners, expected);
    }
  }
}

TEST(Expand, TotalsTooLargeForAnOffsetAreRefused) {
  std::vector<std::uint8_t> narrow(3);
  EXPECT_THROW(offsets_from_counts(std::vector<std::uint8_t>{200, 100}, narrow), ValueError);
  std::vector<std::uint64_t> wide(3);
  const std::uint64_t half = std::uint64_t{1} << 63;
  EXPECT_THROW(offsets_from_counts(std::vector{half, half}, wide), ValueError);
  EXPECT_EQ(offsets_from_counts(std::vector{half, half - 2}, wide), half + (half - 2));
}

TEST(Expand, BadOffsetsAreRefused) {
  using Numbers = std::vector<std::uint32_t>;
  Numbers owners(3);
  EXPECT_THROW(expand(Numbers{}, owners), ValueError);
  EXPECT_THROW(expand(Numbers{1, 3}, owners), ValueError);
  EXPECT_THROW(expand(Numbers{0, 5, 3}, owners), ValueError);
  EXPECT_THROW(expand(Numbers{0, 1, 4}, owners), ShapeError);
  EXPECT_THROW(expand(owners, owners), Error);
  EXPECT_THROW(offsets_from_counts(Numbers{1, 2}, owners = Numbers(2)), ShapeError);
  std::vector<std::uint8_t> narrow(300);
  Numbers many(301);
  for (std::uint32_t i = 0; i < many.size(); ++i) many[i] = i;
  EXPECT_THROW(expand(many, narrow), ValueError);
}

}  // namespace
}  // namespace relumbre
