#include "relumbre/radiosity/row_counter.h"

#include <map>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

TEST(RowCounter, MatchesASortedMap) {
  RandomStream random(1);
  for (const std::size_t columns : {1U, 63U, 64U, 65U, 4095U, 4096U, 4097U, 300000U}) {
    RowCounter counter(columns);
    SparseCounts rows;
    for (std::size_t row = 0; row < 5; ++row) {
      std::map<std::uint32_t, std::uint32_t> expected;
      for (std::size_t i = 0; i < 200 * row; ++i) {
        const auto column = static_cast<std::uint32_t>(random.bits() % columns);
        counter.add(column);
        ++expected[column];
      }
      counter.flush(rows);
      ASSERT_EQ(rows.rows(), row + 1);
      ASSERT_EQ(rows.row_columns(row).size(), expected.size());
      std::size_t i = 0;
      for (const auto& [column, count] : expected) {
        EXPECT_EQ(rows.row_columns(row)[i], column);
        EXPECT_EQ(rows.row_counts(row)[i++], count);
      }
    }
  }
}

}  // namespace
}  // namespace relumbre
