#include "relumbre/radiosity/count_matrix.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/radiosity/random_transport.h"

namespace relumbre {
namespace {

constexpr CountFormat kFormats[] = {CountFormat::kFloat32, CountFormat::kFloat16,
                                    CountFormat::kCounts16, CountFormat::kCounts8};

std::vector<double> dense_row(const SparseCounts& counts, std::size_t row) {
  std::vector<double> values(counts.columns);
  for (std::size_t e = 0; e < counts.row_columns(row).size(); ++e)
    values[counts.row_columns(row)[e]] = counts.row_counts(row)[e];
  return values;
}

SparseCounts counts_with_rays(std::uint32_t rays, std::size_t rows, std::size_t columns) {
  RandomTransportConfig config;
  config.elements = rows, config.patches = columns, config.rays = rays;
  config.concentration = 0.8F;
  return random_transport(config).counts;
}

/// out = C·y of rows [first, last), through the packed operand.
std::vector<float> product(const CountMatrix& matrix, std::size_t first, std::size_t last,
                           const std::vector<float>& y) {
  HugeBuffer operand(matrix.operand_bytes());
  matrix.pack(y.data(), operand.data());
  std::vector<float> out(3 * (last - first));
  matrix.multiply(first, last, y.data(), operand.data(), out.data());
  return out;
}

TEST(CountMatrix, HoldsEveryCountExactly) {
  for (const std::uint32_t rays : {255U, 512U, 70'000U, 10'000'000U}) {
    const SparseCounts counts = counts_with_rays(rays, 41, 29);
    for (const CountFormat format :
         {CountFormat::kFloat32, CountFormat::kCounts16, CountFormat::kCounts8}) {
      const CountMatrix matrix(counts, format);
      std::vector<double> row(29);
      for (std::size_t i = 0; i < 41; ++i) {
        matrix.decode_row(i, row);
        ASSERT_EQ(row, dense_row(counts, i)) << to_string(format) << " row " << i;
      }
    }
  }
}

TEST(CountMatrix, HalfPrecisionRoundsAbove2048) {
  const SparseCounts counts = counts_with_rays(200'000, 17, 5);
  const CountMatrix matrix(counts, CountFormat::kFloat16);
  std::vector<double> row(5);
  for (std::size_t i = 0; i < 17; ++i) {
    matrix.decode_row(i, row);
    const std::vector<double> exact = dense_row(counts, i);
    for (std::size_t p = 0; p < 5; ++p) ASSERT_NEAR(row[p], exact[p], exact[p] / 2048);
  }
}

TEST(CountMatrix, FormatsDifferInBytes) {
  const SparseCounts counts = counts_with_rays(200, 40, 30);
  EXPECT_EQ(CountMatrix(counts, CountFormat::kFloat32).bytes(), 4800U);
  EXPECT_EQ(CountMatrix(counts, CountFormat::kFloat16).bytes(), 2400U);
  EXPECT_EQ(CountMatrix(counts, CountFormat::kCounts16).bytes(), 2400U);
  EXPECT_EQ(CountMatrix(counts, CountFormat::kCounts8).bytes(), 1200U);
}

TEST(CountMatrix, EveryInstructionSetMultipliesAsTheDefinition) {
  for (const std::size_t columns : {1U, 15U, 64U, 67U, 191U, 257U}) {
    const std::size_t rows = 53;
    const SparseCounts counts = counts_with_rays(40'000, rows, columns);
    std::vector<float> y = random_emission(3 * columns, columns);
    for (std::size_t p = 0; p < columns; p += 3) y[p] = -y[p];
    for (const RowKernels& kernels : available_row_kernels()) {
      for (const CountFormat format : kFormats) {
        const CountMatrix matrix(counts, format, kernels);
        const std::vector<float> out = product(matrix, 0, rows, y);
        std::vector<double> row(columns);
        for (std::size_t i = 0; i < rows; ++i) {
          matrix.decode_row(i, row);
          for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (std::size_t p = 0; p < columns; ++p)
              sum += row[p] * static_cast<double>(y[c * columns + p]);
            ASSERT_NEAR(static_cast<double>(out[3 * i + c]), sum, 40'000 * 10 * 2e-6)
                << kernels.name << ' ' << to_string(format) << ' ' << columns << " row " << i;
          }
        }
      }
    }
  }
}

TEST(CountMatrix, ARowDoesNotDependOnItsNeighbours) {
  const SparseCounts counts = counts_with_rays(1024, 61, 97);
  const std::vector<float> y = random_emission(3 * 97, 4);
  for (const RowKernels& kernels : available_row_kernels()) {
    for (const CountFormat format : kFormats) {
      const CountMatrix matrix(counts, format, kernels);
      const std::vector<float> all = product(matrix, 0, 61, y);
      for (std::size_t i = 0; i < 61; ++i) {
        const std::vector<float> one = product(matrix, i, i + 1, y);
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(one[c], all[3 * i + c]) << kernels.name;
      }
    }
  }
}

TEST(CountMatrix, LargestCountsDoNotOverflowTheirSums) {
  const std::size_t columns = 4096;
  SparseCounts counts;
  counts.columns = columns;
  counts.rays = 255 * columns;
  for (std::uint32_t p = 0; p < columns; ++p) {
    counts.column.push_back(p);
    counts.count.push_back(255);
  }
  counts.row_offsets.push_back(columns);
  const std::vector<float> y(3 * columns, -3.0F);
  for (const RowKernels& kernels : available_row_kernels()) {
    const std::vector<float> out =
        product(CountMatrix(counts, CountFormat::kCounts8, kernels), 0, 1, y);
    for (const float value : out) EXPECT_NEAR(value, -3.0F * 255 * 4096, 4.0F) << kernels.name;
  }
}

TEST(CountMatrix, RefusesATableThatCannotExist) {
  SparseCounts counts;
  counts.columns = std::uint64_t{1} << 50;
  counts.rays = 1;
  counts.row_offsets.assign(9, 0);
  EXPECT_THROW(CountMatrix(counts, CountFormat::kCounts8), ValueError);
}

}  // namespace
}  // namespace relumbre
