#include "relumbre/base/huge_array.h"

#include <cstdint>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

TEST(HugeArray, BeginsACacheLineAndFromTwoMebibytesAHugePage) {
  const auto address = [](const HugeBuffer& buffer) {
    return reinterpret_cast<std::uintptr_t>(buffer.data());
  };
  for (const std::size_t bytes : {1UL, 63UL, 64UL, 65UL, 100'000UL})
    EXPECT_EQ(address(HugeBuffer(bytes)) % 64, 0) << bytes;
  for (const std::size_t bytes : {1UL << 21, (1UL << 21) + 1, 5UL << 20})
    EXPECT_EQ(address(HugeBuffer(bytes)) % (1UL << 21), 0) << bytes;
}

TEST(HugeArray, HoldsAsManyValuesAsAskedFor) {
  HugeArray<double> array(300'001);
  ASSERT_EQ(array.size(), 300'001);
  for (double& v : array.span()) v = 3;
  const HugeArray<double> moved = std::move(array);
  EXPECT_EQ(moved.span().back(), 3);
  EXPECT_EQ(moved.span().size(), 300'001);
  EXPECT_EQ(array.size(), 0);  // NOLINT(bugprone-use-after-move): moved from: empty
  EXPECT_EQ(HugeArray<float>(0).data(), nullptr);
}

TEST(HugeArray, SizesThatNoMemoryHasAreRefused) {
  constexpr std::size_t all = std::numeric_limits<std::size_t>::max();
  EXPECT_THROW(HugeArray<double>{all / 4}, std::bad_alloc);
  EXPECT_THROW(HugeBuffer{all}, std::bad_alloc);
}

}  // namespace
}  // namespace relumbre
