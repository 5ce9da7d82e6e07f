#include "relumbre/radiosity/solver.h"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

using testing::HasSubstr;

constexpr SolveMethod kMethods[] = {SolveMethod::kJacobi, SolveMethod::kGaussSeidel,
                                    SolveMethod::kBiCgStab};

/// Rows of `rays` rays thrown at random columns; a share of them escapes.
SparseCounts random_counts(std::size_t n, std::uint32_t rays, float escaping, std::uint64_t seed) {
  SparseCounts counts;
  counts.columns = n;
  counts.rays = rays;
  RandomStream random(seed);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::uint32_t> row(n);
    for (std::uint32_t r = 0; r < rays; ++r) {
      if (random.uniform() >= escaping) ++row[random.bits() % n];
    }
    for (std::uint32_t j = 0; j < n; ++j) {
      if (row[j] == 0) continue;
      counts.column.push_back(j);
      counts.count.push_back(row[j]);
    }
    counts.row_offsets.push_back(counts.column.size());
  }
  return counts;
}

std::vector<Rgb> random_rgb(std::size_t n, float scale, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<Rgb> values(n);
  for (Rgb& v : values) v = Rgb(random.uniform(), random.uniform(), random.uniform()) * scale;
  return values;
}

/// The obvious twin: Gaussian elimination with partial pivoting on the dense I − RF.
std::vector<double> solve_dense(const SparseCounts& counts, const std::vector<Rgb>& reflectance,
                                const std::vector<Rgb>& emission, std::size_t channel) {
  const std::size_t n = counts.rows();
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1));
  for (std::size_t i = 0; i < n; ++i) {
    a[i][i] = 1;
    a[i][n] = static_cast<double>(emission[i][channel]);
    for (std::size_t e = 0; e < counts.row_columns(i).size(); ++e) {
      a[i][counts.row_columns(i)[e]] -=
          static_cast<double>(reflectance[i][channel]) * counts.row_counts(i)[e] / counts.rays;
    }
  }
  for (std::size_t p = 0; p < n; ++p) {
    std::size_t best = p;
    for (std::size_t i = p; i < n; ++i) best = std::abs(a[i][p]) > std::abs(a[best][p]) ? i : best;
    std::swap(a[p], a[best]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == p) continue;
      const double factor = a[i][p] / a[p][p];
      for (std::size_t j = p; j <= n; ++j) a[i][j] -= factor * a[p][j];
    }
  }
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = a[i][n] / a[i][i];
  return x;
}

TEST(Solver, MatchesDenseEliminationAtAwkwardSizes) {
  for (const std::size_t n : {1U, 2U, 3U, 31U, 127U, 130U}) {
    const SparseCounts counts = random_counts(n, 97, 0.1F, n);
    const auto reflectance = random_rgb(n, 0.98F, 2 * n + 1);
    const auto emission = random_rgb(n, 7.0F, 3 * n + 1);
    for (const SolveMethod method : kMethods) {
      const SolveResult result =
          solve_radiosity(counts, reflectance, emission, {.method = method, .tolerance = 1e-9});
      for (std::size_t c = 0; c < 3; ++c) {
        const auto expected = solve_dense(counts, reflectance, emission, c);
        for (std::size_t i = 0; i < n; ++i) {
          EXPECT_NEAR(result.radiosity[i][c] / expected[i], 1, 1e-6)
              << to_string(method) << " n=" << n << " element " << i;
        }
      }
    }
  }
}

TEST(Solver, FurnaceRadiosityIsOneOverOneMinusRho) {
  const std::size_t n = 257;
  const SparseCounts closed = random_counts(n, 64, 0.0F, 5);
  const std::vector<Rgb> reflectance(n, Rgb(0.0F, 0.5F, 0.9F)), emission(n, Rgb(1.0F, 2.0F, 3.0F));
  for (const SolveMethod method : kMethods) {
    const SolveResult result =
        solve_radiosity(closed, reflectance, emission, {.method = method, .tolerance = 1e-7});
    EXPECT_LE(result.residual, 1e-7);
    for (const Rgb& b : result.radiosity) {
      EXPECT_NEAR(b.x, 1.0, 1e-6) << to_string(method);
      EXPECT_NEAR(b.y, 4.0, 4e-6) << to_string(method);
      EXPECT_NEAR(b.z, 30.0, 3e-4) << to_string(method);
    }
  }
}

TEST(Solver, MethodsAgreeAndKrylovNeedsFewestIterations) {
  const std::size_t n = 500;
  const SparseCounts counts = random_counts(n, 128, 0.02F, 11);
  const auto reflectance = random_rgb(n, 0.99F, 12), emission = random_rgb(n, 1.0F, 13);
  std::vector<SolveResult> results;
  for (const SolveMethod method : kMethods) {
    results.push_back(
        solve_radiosity(counts, reflectance, emission, {.method = method, .tolerance = 1e-8}));
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t m = 1; m < 3; ++m) {
      EXPECT_NEAR(results[m].radiosity[i].x, results[0].radiosity[i].x, 2e-6);
      EXPECT_NEAR(results[m].radiosity[i].z, results[0].radiosity[i].z, 2e-6);
    }
  }
  EXPECT_LT(results[1].iterations, results[0].iterations);
  EXPECT_LT(results[2].iterations, results[1].iterations);
}

TEST(Solver, ResultDoesNotDependOnThreads) {
  const std::size_t n = 9001;
  const SparseCounts counts = random_counts(n, 8, 0.1F, 21);
  const auto reflectance = random_rgb(n, 0.9F, 22), emission = random_rgb(n, 1.0F, 23);
  for (const SolveMethod method : {SolveMethod::kJacobi, SolveMethod::kBiCgStab}) {
    std::vector<SolveResult> results;
    for (const std::size_t threads : {1U, 2U, 3U}) {
      const ThreadLimit limit(threads);
      results.push_back(solve_radiosity(counts, reflectance, emission, {.method = method}));
    }
    EXPECT_EQ(results[0].radiosity, results[1].radiosity);
    EXPECT_EQ(results[0].radiosity, results[2].radiosity);
    EXPECT_EQ(results[0].residual, results[1].residual);
  }
}

TEST(Solver, ZeroEmissionGivesZeroWithoutIterating) {
  const SparseCounts counts = random_counts(10, 16, 0.0F, 1);
  const std::vector<Rgb> reflectance(10, Rgb(0.5F)), dark(10);
  for (const SolveMethod method : kMethods) {
    const SolveResult result = solve_radiosity(counts, reflectance, dark, {.method = method});
    EXPECT_EQ(result.radiosity, dark);
    EXPECT_EQ(result.iterations, 0U);
    EXPECT_EQ(result.residual, 0.0);
  }
}

TEST(Solver, DarkChannelStaysDarkBesideALitOne) {
  const SparseCounts counts = random_counts(40, 32, 0.1F, 2);
  const std::vector<Rgb> reflectance(40, Rgb(0.7F)), emission(40, Rgb(0.0F, 1.0F, 0.0F));
  for (const SolveMethod method : kMethods) {
    for (const Rgb& b :
         solve_radiosity(counts, reflectance, emission, {.method = method}).radiosity) {
      EXPECT_EQ(b.x, 0.0F);
      EXPECT_GT(b.y, 1.0F);
      EXPECT_EQ(b.z, 0.0F);
    }
  }
}

TEST(Solver, NoElementsIsNoWork) {
  SparseCounts none;
  none.rays = 1;
  EXPECT_TRUE(solve_radiosity(none, {}, {}).radiosity.empty());
}

TEST(Solver, IterationCapNamesTheResidual) {
  const SparseCounts counts = random_counts(50, 32, 0.0F, 3);
  const std::vector<Rgb> reflectance(50, Rgb(0.95F));
  const auto emission = random_rgb(50, 1.0F, 4);
  for (const SolveMethod method : kMethods) {
    try {
      solve_radiosity(counts, reflectance, emission,
                      {.method = method, .tolerance = 1e-12, .max_iterations = 2});
      FAIL() << to_string(method);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("residual of "));
      EXPECT_THAT(error.what(), HasSubstr("after 2 iterations"));
      EXPECT_THAT(error.what(), HasSubstr(std::string(to_string(method))));
    }
  }
}

TEST(Solver, UnreachableToleranceIsAnError) {
  const SparseCounts counts = random_counts(50, 32, 0.0F, 3);
  const std::vector<Rgb> reflectance(50, Rgb(0.9F));
  const auto emission = random_rgb(50, 1.0F, 4);
  EXPECT_THROW(
      solve_radiosity(counts, reflectance, emission, {.tolerance = 1e-300, .max_iterations = 300}),
      Error);
}

TEST(Solver, RefusesShapesThatDisagree) {
  const SparseCounts counts = random_counts(5, 8, 0.0F, 1);
  const std::vector<Rgb> five(5, Rgb(0.5F)), four(4, Rgb(0.5F));
  EXPECT_THROW(solve_radiosity(counts, four, five), ShapeError);
  EXPECT_THROW(solve_radiosity(counts, five, four), ShapeError);
  EXPECT_THROW(residual(counts, five, five, four), ShapeError);
  SparseCounts wide = counts;
  wide.columns = 6;
  EXPECT_THROW(solve_radiosity(wide, five, five), ShapeError);
}

TEST(Solver, RefusesBadValues) {
  const SparseCounts counts = random_counts(3, 8, 0.0F, 1);
  const std::vector<Rgb> good(3, Rgb(0.5F)), white(3, Rgb(1.0F)), negative(3, Rgb(-0.1F));
  const std::vector<Rgb> broken(3, Rgb(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_THROW(solve_radiosity(counts, white, good), ValueError);
  EXPECT_THROW(solve_radiosity(counts, negative, good), ValueError);
  EXPECT_THROW(solve_radiosity(counts, broken, good), ValueError);
  EXPECT_THROW(solve_radiosity(counts, good, broken), ValueError);
  EXPECT_THROW(solve_radiosity(counts, good, good, {.tolerance = 0}), ValueError);
  EXPECT_THROW(residual(counts, good, good, broken), ValueError);
}

TEST(Solver, StopsWhenCancelled) {
  struct Stop : Progress {
    [[nodiscard]] bool cancelled() const override { return true; }
  } stop;
  const SparseCounts counts = random_counts(20, 8, 0.0F, 1);
  const std::vector<Rgb> half(20, Rgb(0.5F));
  EXPECT_THROW(solve_radiosity(counts, half, random_rgb(20, 1.0F, 1), {}, stop), Cancelled);
}

TEST(Residual, IsTheSourceMinusTheOperator) {
  // Two elements that see each other with 3 of 4 rays: r = E − B + ρ ¾ B_other.
  SparseCounts counts;
  counts.columns = 2;
  counts.rays = 4;
  counts.row_offsets = {0, 1, 2};
  counts.column = {1, 0};
  counts.count = {3, 3};
  const std::vector<Rgb> reflectance{Rgb(0.5F), Rgb(0.25F)}, emission{Rgb(1.0F), Rgb(0.0F)},
      radiosity{Rgb(2.0F), Rgb(4.0F)};
  const auto r = residual(counts, reflectance, emission, radiosity);
  EXPECT_FLOAT_EQ(r[0].x, 1.0F - 2.0F + 0.5F * 0.75F * 4.0F);
  EXPECT_FLOAT_EQ(r[1].y, 0.0F - 4.0F + 0.25F * 0.75F * 2.0F);
}

}  // namespace
}  // namespace relumbre
