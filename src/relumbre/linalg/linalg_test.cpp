#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/linalg/blas.h"
#include "relumbre/linalg/inverse.h"

namespace relumbre {
namespace {

/// Diagonally dominant, as I - VᵀRU is.
std::vector<double> dominant_matrix(std::size_t n, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<double> a(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      a[i * n + j] = -static_cast<double>(random.uniform()) / static_cast<double>(n);
    a[i * n + i] += 1.5;
  }
  return a;
}

std::vector<float> random_floats(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<float> values(count);
  for (float& v : values) v = random.uniform() - 0.5F;
  return values;
}

class InverseOfOrder : public testing::TestWithParam<std::size_t> {};

TEST_P(InverseOfOrder, TimesTheMatrixIsIdentity) {
  const std::size_t n = GetParam();
  const std::vector<double> a = dominant_matrix(n, n);
  std::vector<double> b = a;
  invert(b, n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      double sum = 0;
      for (std::size_t l = 0; l < n; ++l) sum += a[i * n + l] * b[l * n + j];
      ASSERT_NEAR(sum, i == j ? 1.0 : 0.0, 1e-12) << i << ' ' << j;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Orders, InverseOfOrder, testing::Values(1, 2, 7, 64, 131, 521));

TEST(Inverse, PivotsWhereTheDiagonalIsZero) {
  std::vector<double> a{0, 2, 4, 0};
  invert(a, 2);
  EXPECT_EQ(a, (std::vector<double>{0, 0.25, 0.5, 0}));
}

TEST(Inverse, RefusesSingularAndUnfiniteMatrices) {
  std::vector<double> singular{1, 2, 2, 4};
  EXPECT_THROW(invert(singular, 2), Error);
  std::vector<double> unfinite{1, 2, std::numeric_limits<double>::infinity(), 4};
  EXPECT_THROW(invert(unfinite, 2), Error);
}

TEST(Inverse, RefusesAWrongShape) {
  std::vector<double> a(5);
  EXPECT_THROW(invert(a, 2), ShapeError);
  EXPECT_THROW(invert(a, 50000), ValueError);
}

TEST(Blas, GemvMatchesTheSum) {
  const std::size_t m = 37, n = 23;
  const std::vector<float> a = random_floats(m * n, 1), x = random_floats(n, 2);
  std::vector<float> y = random_floats(m, 3);
  const std::vector<float> before = y;
  gemv(Transpose::kNo, 2.0F, {a, m, n}, x, 0.5F, y);
  for (std::size_t i = 0; i < m; ++i) {
    float sum = 0.5F * before[i];
    for (std::size_t j = 0; j < n; ++j) sum += 2.0F * a[j * m + i] * x[j];
    EXPECT_NEAR(y[i], sum, 1e-5F);
  }
}

TEST(Blas, TransposedGemvMatchesTheSum) {
  const std::size_t m = 37, n = 23;
  const std::vector<float> a = random_floats(m * n, 1), x = random_floats(m, 2);
  std::vector<float> y(n);
  gemv(Transpose::kYes, 1.0F, {a, m, n}, x, 0.0F, y);
  for (std::size_t j = 0; j < n; ++j) {
    float sum = 0;
    for (std::size_t i = 0; i < m; ++i) sum += a[j * m + i] * x[i];
    EXPECT_NEAR(y[j], sum, 1e-5F);
  }
}

TEST(Blas, GemmMatchesTheSum) {
  const std::size_t m = 13, n = 7, l = 19;
  const std::vector<float> a = random_floats(m * l, 1), b = random_floats(l * n, 2);
  std::vector<float> c(m * n);
  gemm(-1.0F, {a, m, l}, {b, l, n}, c);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      float sum = 0;
      for (std::size_t p = 0; p < l; ++p) sum -= a[p * m + i] * b[j * l + p];
      EXPECT_NEAR(c[j * m + i], sum, 1e-5F);
    }
  }
}

TEST(Blas, RefusesShapesThatDisagree) {
  const std::vector<float> a(6), x(3);
  std::vector<float> y(3);
  EXPECT_THROW(gemv(Transpose::kNo, 1, {a, 2, 3}, x, 0, y), ShapeError);
  EXPECT_THROW(gemv(Transpose::kNo, 1, {a, 2, 2}, std::span(x).first(2), 0, std::span(y).first(2)),
               ShapeError);
  EXPECT_THROW(gemm(1, {a, 2, 3}, {a, 2, 3}, y), ShapeError);
}

}  // namespace
}  // namespace relumbre
