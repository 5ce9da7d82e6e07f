#include "relumbre/scan/segmented.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan_testing.h"

namespace relumbre {
namespace {

using scan_testing::random_values;
using scan_testing::sizes_around;

template <class M, class T = typename M::value_type>
std::vector<T> slow(const std::vector<T>& in, const std::vector<std::uint8_t>& heads, const M& m,
                    ScanKind kind) {
  std::vector<T> out;
  T sum = m.identity();
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (heads[i]) sum = m.identity();
    const T next = m(sum, in[i]);
    out.push_back(kind == ScanKind::kInclusive ? next : sum);
    sum = next;
  }
  return out;
}

/// Few heads, so that segments span tiles, or many.
std::vector<std::uint8_t> random_heads(std::size_t size, int one_in) {
  auto heads = random_values<std::uint8_t>(size, 0, 255);
  const auto draws = random_values<int>(size, 0, one_in - 1);
  for (std::size_t i = 0; i < size; ++i) heads[i] = draws[i] == 0 ? 1 : 0;
  return heads;
}

template <class M, class Make, class T = typename M::value_type>
void expect_matches_loop(const M& m, const Make& make) {
  for (const std::size_t size : sizes_around(scan_detail::kTile<T>)) {
    for (const int one_in : {1, 5, 30'000}) {
      const std::vector<T> in = make(size);
      const auto heads = random_heads(size, one_in);
      for (const ScanKind kind : {ScanKind::kInclusive, ScanKind::kExclusive}) {
        const std::vector<T> expected = slow(in, heads, m, kind);
        for (const std::size_t threads : {1, 2, 8}) {
          const ThreadLimit limit(threads);
          std::vector<T> out(size), in_place = in;
          const T total = segmented_scan(in, heads, out, m, kind);
          EXPECT_TRUE(out == expected) << size;
          segmented_scan(in_place, heads, in_place, m, kind);
          EXPECT_TRUE(in_place == expected) << size;
          EXPECT_TRUE(size == 0 || kind == ScanKind::kExclusive || total == out.back());
        }
      }
    }
  }
}

TEST(SegmentedScan, MatchesALoopThatStartsAnew) {
  expect_matches_loop<Plus<std::uint32_t>>(
      {}, [](std::size_t n) { return random_values<std::uint32_t>(n, 0, ~0U); });
  expect_matches_loop(Max<float>(), [](std::size_t n) { return random_values<float>(n, -1, 1); });
}

TEST(SegmentedScan, KeepsTheOrderWhereTheOperationDoesNotCommute) {
  using Map = Affine<std::uint32_t>;
  expect_matches_loop(Compose<std::uint32_t>(), [](std::size_t n) {
    const auto entries = random_values<std::uint32_t>(2 * n, 0, ~0U);
    std::vector<Map> maps(n);
    for (std::size_t i = 0; i < n; ++i) maps[i] = {entries[2 * i], entries[2 * i + 1]};
    return maps;
  });
}

TEST(SegmentedScan, OneSegmentIsAPlainScan) {
  const auto in = random_values<std::uint64_t>(50'000, 0, 1000);
  std::vector<std::uint64_t> out(in.size()), plain(in.size());
  segmented_scan(in, std::vector<char>(in.size()), out);
  inclusive_scan(in, plain);
  EXPECT_EQ(out, plain);
}

TEST(SegmentedScan, FloatsHaveTheSameBitsForAnyNumberOfThreads) {
  const auto in = random_values<float>(200'000, -1, 1);
  const auto heads = random_heads(in.size(), 50'000);
  std::vector<float> alone(in.size()), many(in.size());
  {
    const ThreadLimit one(1);
    segmented_scan(in, heads, alone);
  }
  const ThreadLimit eight(8);
  segmented_scan(in, heads, many);
  EXPECT_EQ(alone, many);
}

TEST(ScanByKey, RunsOfEqualKeysAreSegments) {
  const std::vector<std::string> keys{"a", "a", "b", "a", "a", "a"};
  const std::vector<int> in{1, 2, 3, 4, 5, 6};
  std::vector<int> out(in.size());
  EXPECT_EQ(scan_by_key(keys, in, out), 15);
  EXPECT_EQ(out, (std::vector<int>{1, 3, 3, 4, 9, 15}));
  EXPECT_EQ(scan_by_key(keys, in, out, Plus<int>(), ScanKind::kExclusive), 15);
  EXPECT_EQ(out, (std::vector<int>{0, 1, 0, 0, 4, 9}));
}

TEST(ScanByKey, MatchesSegmentsByHeads) {
  const std::size_t size = 3 * scan_detail::kTile<int> + 5;
  const auto keys = random_values<std::uint8_t>(size, 0, 1);
  const auto in = random_values<int>(size, -100, 100);
  std::vector<std::uint8_t> heads(size, 1);
  for (std::size_t i = 1; i < size; ++i) heads[i] = keys[i] != keys[i - 1];
  std::vector<int> by_key(size), by_head(size);
  scan_by_key(keys, in, by_key);
  segmented_scan(in, heads, by_head);
  EXPECT_EQ(by_key, by_head);
}

TEST(SegmentedScan, BadShapesAreRefused) {
  std::vector<int> in(5), out(5), heads(4);
  EXPECT_THROW(segmented_scan(in, heads, out), ShapeError);
  EXPECT_THROW(scan_by_key(heads, in, out), ShapeError);
  EXPECT_THROW(segmented_scan(in, in, std::span(out).first(4)), ShapeError);
  EXPECT_THROW(segmented_scan(in, out, out), ValueError);
  EXPECT_THROW(scan_by_key(out, in, out), ValueError);
}

}  // namespace
}  // namespace relumbre
