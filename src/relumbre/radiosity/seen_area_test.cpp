#include "relumbre/radiosity/seen_area.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

/// Three elements that saw 4, 1 and 0 of 4 rays arrive.
SparseCounts three_rows() {
  SparseCounts counts;
  counts.columns = 2;
  counts.rays = 4;
  counts.row_offsets = {0, 2, 3, 3};
  counts.column = {0, 1, 1};
  counts.count = {3, 1, 1};
  return counts;
}

TEST(SeenArea, IsAreaTimesRowSum) {
  const std::vector<float> area = {2, 8, 1};
  const std::vector<float> seen = seen_area(three_rows(), area);
  EXPECT_FLOAT_EQ(seen[0], 2);
  EXPECT_FLOAT_EQ(seen[1], 2);
}

TEST(SeenArea, UnseenElementsKeepALittle) {
  const std::vector<float> area = {2, 8, 1};
  const float unseen = seen_area(three_rows(), area)[2];
  EXPECT_GT(unseen, 0);
  EXPECT_LT(unseen, 1e-5F);
}

TEST(SeenArea, RefusesAreasOfAnotherScene) {
  EXPECT_THROW((void)seen_area(three_rows(), std::vector<float>(2, 1.0F)), ShapeError);
}

}  // namespace
}  // namespace relumbre
