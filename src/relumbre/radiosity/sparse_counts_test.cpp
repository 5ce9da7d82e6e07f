#include "relumbre/radiosity/sparse_counts.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

SparseCounts valid_counts() {
  SparseCounts counts;
  counts.columns = 5;
  counts.rays = 8;
  counts.row_offsets = {0, 2, 2, 4};
  counts.column = {1, 4, 0, 3};
  counts.count = {3, 5, 1, 2};
  return counts;
}

TEST(SparseCounts, RowsAreSlicesOfTheArrays) {
  const SparseCounts counts = valid_counts();
  EXPECT_NO_THROW(validate(counts));
  EXPECT_EQ(counts.rows(), 3U);
  EXPECT_EQ(counts.nonzeros(), 4U);
  EXPECT_TRUE(counts.row_columns(1).empty());
  EXPECT_EQ(counts.row_columns(2)[1], 3U);
  EXPECT_EQ(counts.row_counts(2)[1], 2U);
  EXPECT_NO_THROW(validate(SparseCounts{}));
}

TEST(SparseCounts, EveryBrokenInvariantIsFound) {
  const auto expect_refused = [](auto&& spoil) {
    SparseCounts counts = valid_counts();
    spoil(counts);
    EXPECT_THROW(validate(counts), ValueError);
  };
  expect_refused([](SparseCounts& c) { c.row_offsets.clear(); });
  expect_refused([](SparseCounts& c) { c.row_offsets[0] = 1; });
  expect_refused([](SparseCounts& c) { c.row_offsets[1] = 3; });
  expect_refused([](SparseCounts& c) { c.row_offsets[3] = 5; });
  expect_refused([](SparseCounts& c) { c.row_offsets[2] = ~std::uint64_t{0}; });
  expect_refused([](SparseCounts& c) { c.count.pop_back(); });
  expect_refused([](SparseCounts& c) { c.column[1] = 5; });
  expect_refused([](SparseCounts& c) { c.column[1] = 1; });
  expect_refused([](SparseCounts& c) { c.column[1] = 0; });
  expect_refused([](SparseCounts& c) { c.count[3] = 0; });
  expect_refused([](SparseCounts& c) { c.count[0] = 4; });
  expect_refused([](SparseCounts& c) { c.count[0] = 0xFFFFFFFFU; });
}

TEST(SparseCounts, TheMessageNamesTheRow) {
  SparseCounts counts = valid_counts();
  counts.count[3] = 99;
  try {
    validate(counts);
    FAIL();
  } catch (const ValueError& error) {
    EXPECT_STREQ(error.what(), "counts: row 2 has 100 hits of 8 rays");
  }
}

}  // namespace
}  // namespace relumbre
