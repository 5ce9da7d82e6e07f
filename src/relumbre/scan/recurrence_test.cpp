#include "relumbre/scan/recurrence.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan_testing.h"
#include "relumbre/scan/tridiagonal.h"

namespace relumbre {
namespace {

using scan_testing::random_values;
using scan_testing::sizes_around;
using Doubles = std::vector<double>;

double largest_difference(const Doubles& a, const Doubles& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(LinearRecurrence, MatchesALoop) {
  for (const std::size_t size : sizes_around(scan_detail::kTile<double>)) {
    const Doubles a = random_values<double>(size, -1, 1), b = random_values<double>(size, -2, 2);
    Doubles expected(size);
    double x = 0.7;
    for (std::size_t i = 0; i < size; ++i) expected[i] = x = a[i] * x + b[i];
    const double last = x;
    for (const std::size_t threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      Doubles out(size);
      EXPECT_NEAR(linear_recurrence(a, b, out, 0.7), last, 1e-12);
      EXPECT_LT(largest_difference(out, expected), 1e-12);
    }
  }
}

TEST(LinearRecurrence, BackwardIsForwardOfTheReversed) {
  Doubles a = random_values<double>(30'011, -1, 1), b = random_values<double>(30'011, -2, 2);
  Doubles forward(a.size()), backward(a.size());
  linear_recurrence(a, b, forward, 3.0);
  std::ranges::reverse(a), std::ranges::reverse(b);
  linear_recurrence(a, b, backward, 3.0, Direction::kBackward);
  std::ranges::reverse(backward);
  EXPECT_EQ(forward, backward);
}

TEST(LinearRecurrence, MayOverwriteEitherInput) {
  const Doubles a = random_values<double>(60'000, -1, 1), b = random_values<double>(60'000, -2, 2);
  Doubles apart(a.size()), over_a = a, over_b = b;
  linear_recurrence(a, b, apart);
  linear_recurrence(over_a, b, over_a);
  linear_recurrence(a, over_b, over_b);
  EXPECT_EQ(over_a, apart);
  EXPECT_EQ(over_b, apart);
}

TEST(LinearRecurrence, HasTheSameBitsForAnyNumberOfThreads) {
  const Doubles a = random_values<double>(99'991, -1, 1), b = random_values<double>(99'991, -2, 2);
  Doubles alone(a.size());
  {
    const ThreadLimit one(1);
    linear_recurrence(a, b, alone);
  }
  for (const std::size_t threads : {2, 3, 8}) {
    const ThreadLimit limit(threads);
    Doubles out(a.size());
    linear_recurrence(a, b, out);
    EXPECT_EQ(out, alone);
  }
}

TEST(LinearRecurrence, ConstantFactorDecaysGeometrically) {
  const std::size_t size = 1000;
  Doubles b(size), x(size);
  b[0] = 1;
  linear_recurrence(Doubles(size, 0.5), b, x);
  for (std::size_t i = 0; i < size; ++i) EXPECT_DOUBLE_EQ(x[i], std::pow(0.5, i));
}

TEST(LinearRecurrence, BadArraysAreRefused) {
  Doubles a(4), b(5), x(5), long_x(6);
  EXPECT_THROW(linear_recurrence(a, b, x), ShapeError);
  EXPECT_THROW(linear_recurrence(b, a, x), ShapeError);
  EXPECT_THROW(linear_recurrence(b, std::span(long_x).first(5), std::span(long_x).last(5)),
               ValueError);
}

struct System {
  Doubles lower, diagonal, upper, rhs;
};

/// `excess` over the sum of the others on every diagonal.
System random_system(std::size_t size, double excess) {
  System s{random_values<double>(size, -1, 1), Doubles(size), random_values<double>(size, -1, 1),
           random_values<double>(size, -3, 3)};
  std::ranges::reverse(s.upper);
  for (std::size_t i = 0; i < size; ++i) {
    s.diagonal[i] = std::abs(s.lower[i]) + std::abs(s.upper[i]) + excess;
    if (i % 3 == 1) s.diagonal[i] = -s.diagonal[i];
  }
  return s;
}

/// The Thomas algorithm.
Doubles slow_solve(const System& s) {
  const std::size_t n = s.diagonal.size();
  Doubles ratio(n), x(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double pivot = i == 0 ? s.diagonal[0] : s.diagonal[i] - s.lower[i] * ratio[i - 1];
    ratio[i] = s.upper[i] / pivot;
    x[i] = (s.rhs[i] - (i == 0 ? 0 : s.lower[i] * x[i - 1])) / pivot;
  }
  for (std::size_t i = n; i-- > 1;) x[i - 1] -= ratio[i - 1] * x[i];
  return x;
}

double largest_residual(const System& s, const Doubles& x) {
  double largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double r = s.diagonal[i] * x[i] - s.rhs[i];
    if (i > 0) r += s.lower[i] * x[i - 1];
    if (i + 1 < x.size()) r += s.upper[i] * x[i + 1];
    largest = std::max(largest, std::abs(r));
  }
  return largest;
}

Doubles solve(const System& s) {
  Doubles x(s.rhs.size());
  solve_tridiagonal(s.lower, s.diagonal, s.upper, s.rhs, std::span(x));
  return x;
}

TEST(Tridiagonal, MatchesTheThomasAlgorithm) {
  for (const std::size_t size : sizes_around(scan_detail::kTile<double>)) {
    const System s = random_system(size, 0.1);
    const Doubles expected = slow_solve(s);
    for (const std::size_t threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      const Doubles x = solve(s);
      EXPECT_LT(largest_difference(x, expected), 1e-11) << size;
      EXPECT_LT(largest_residual(s, x), 1e-12) << size;
    }
  }
}

/// -u'' = 1 with u = 0 at both ends: dominant, but not strictly; the condition grows with n².
TEST(Tridiagonal, PoissonsEquationHasItsParabola) {
  const std::size_t size = 20'000;
  const System s{Doubles(size, -1), Doubles(size, 2), Doubles(size, -1), Doubles(size, 1)};
  const Doubles x = solve(s);
  const auto n = static_cast<double>(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double k = static_cast<double>(i) + 1, exact = k * (n + 1 - k) / 2;
    ASSERT_NEAR(x[i], exact, 1e-6 * exact);
  }
}

TEST(Tridiagonal, MayOverwriteTheRightHandSide) {
  System s = random_system(30'000, 0.5);
  const Doubles apart = solve(s);
  solve_tridiagonal(s.lower, s.diagonal, s.upper, s.rhs, std::span(s.rhs));
  EXPECT_EQ(s.rhs, apart);
}

TEST(Tridiagonal, Float32IsSolvedToo) {
  const System s = random_system(5000, 0.5);
  const auto narrow = [](const Doubles& v) { return std::vector<float>(v.begin(), v.end()); };
  std::vector<float> x(s.rhs.size());
  solve_tridiagonal(narrow(s.lower), narrow(s.diagonal), narrow(s.upper), narrow(s.rhs),
                    std::span(x));
  const Doubles expected = slow_solve(s);
  for (std::size_t i = 0; i < x.size(); ++i)
    ASSERT_NEAR(static_cast<double>(x[i]), expected[i], 1e-4);
}

TEST(Tridiagonal, WhatIsOutsideItsDomainIsRefused) {
  System s = random_system(10, 0.5);
  s.diagonal[4] = 0.9 * (std::abs(s.lower[4]) + std::abs(s.upper[4]));
  EXPECT_THROW(solve(s), ValueError);
  s.diagonal[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solve(s), ValueError);
  // Dominant, yet singular: constants are in its null space.
  const System neumann{{0, -1, -1}, {1, 2, 1}, {-1, -1, 0}, {1, 1, 1}};
  EXPECT_THROW(solve(neumann), ValueError);
  s.diagonal.pop_back();
  EXPECT_THROW(solve(s), ShapeError);
  s = random_system(10, 0.5);
  EXPECT_THROW(solve_tridiagonal(s.lower, s.diagonal, s.upper, s.rhs, std::span(s.upper)),
               ValueError);
}

}  // namespace
}  // namespace relumbre
