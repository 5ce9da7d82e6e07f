#include "relumbre/scan/radix_sort.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/scan/scan_testing.h"

namespace relumbre {
namespace {

/// Against the standard library's stable sort.
template <class Key>
void expect_sorts(std::size_t size, unsigned bits) {
  const Key most = bits >= 8 * sizeof(Key) ? ~Key{0} : static_cast<Key>((Key{1} << bits) - 1);
  std::vector<Key> keys = scan_testing::random_values<Key>(size, 0, most);
  std::vector<std::uint32_t> values(size);
  std::iota(values.begin(), values.end(), 0U);
  std::vector<std::uint32_t> expected = values;
  std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return keys[i]; });
  std::vector<Key> expected_keys = keys;
  std::ranges::sort(expected_keys);
  radix_sort(keys, values, bits);
  EXPECT_EQ(keys, expected_keys) << size;
  EXPECT_EQ(values, expected) << size;
}

TEST(RadixSort, IsStableAtAnySizeAndWidth) {
  for (const std::size_t size : {0UL, 1UL, 2UL, 255UL, 65'535UL, 65'536UL, 200'003UL}) {
    expect_sorts<std::uint32_t>(size, 1);
    expect_sorts<std::uint32_t>(size, 12);
    expect_sorts<std::uint32_t>(size, 32);
    expect_sorts<std::uint64_t>(size, 51);
  }
}

TEST(RadixSort, DoesNotDependOnTheNumberOfThreads) {
  const ThreadLimit one(1);
  expect_sorts<std::uint32_t>(150'001, 9);
}

TEST(RadixSort, BitsAboveTheWidthAreLeftAlone) {
  std::vector<std::uint32_t> keys{0x302, 0x201, 0x102}, values{0, 1, 2};
  radix_sort(keys, values, 8);
  EXPECT_EQ(keys, (std::vector<std::uint32_t>{0x201, 0x302, 0x102}));
}

TEST(RadixSort, SizesMustAgree) {
  std::vector<std::uint32_t> keys(3), values(2);
  EXPECT_THROW(radix_sort(keys, values, 8), ShapeError);
}

}  // namespace
}  // namespace relumbre
