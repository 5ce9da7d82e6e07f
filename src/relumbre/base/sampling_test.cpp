#include "relumbre/base/sampling.h"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

/// The m leading bits of a 32-bit fraction.
std::uint32_t stratum(std::uint32_t fraction, unsigned m) {
  return m == 0 ? 0 : fraction >> (32 - m);
}

std::array<double, 4> fractions(std::uint32_t index) {
  const auto p = sobol4(index);
  return {p[0] * 0x1p-32, p[1] * 0x1p-32, p[2] * 0x1p-32, p[3] * 0x1p-32};
}

TEST(Sobol, FirstPointsAreThePublishedOnes) {
  using Point = std::array<double, 4>;
  EXPECT_EQ(fractions(0), (Point{0, 0, 0, 0}));
  EXPECT_EQ(fractions(1), (Point{0.5, 0.5, 0.5, 0.5}));
  EXPECT_EQ(fractions(2), (Point{0.25, 0.75, 0.75, 0.75}));
  EXPECT_EQ(fractions(3), (Point{0.75, 0.25, 0.25, 0.25}));
  EXPECT_EQ(fractions(4), (Point{0.125, 0.625, 0.375, 0.125}));
  EXPECT_EQ(fractions(6), (Point{0.375, 0.375, 0.625, 0.875}));
}

TEST(Sobol, EveryAlignedRunIsStratifiedInEveryDimension) {
  for (unsigned m = 0; m <= 10; ++m) {
    for (const std::uint32_t run : {0U, 1U, 5U, 1000U}) {
      std::array<std::set<std::uint32_t>, 4> strata;
      for (std::uint32_t i = 0; i < (1U << m); ++i) {
        const auto p = sobol4((run << m) + i);
        for (std::size_t d = 0; d < 4; ++d) strata[d].insert(stratum(p[d], m));
      }
      for (const auto& s : strata) EXPECT_EQ(s.size(), 1U << m);
    }
  }
}

TEST(Sobol, FirstPairHasOnePointInEveryElementaryInterval) {
  for (unsigned m = 0; m <= 8; ++m) {
    for (unsigned a = 0; a <= m; ++a) {
      for (const std::uint32_t run : {0U, 3U, 77U}) {
        std::set<std::uint32_t> cells;
        for (std::uint32_t i = 0; i < (1U << m); ++i) {
          const auto p = sobol4((run << m) + i);
          cells.insert((stratum(p[0], a) << (m - a)) + stratum(p[1], m - a));
        }
        EXPECT_EQ(cells.size(), 1U << m) << "m " << m << ", a " << a << ", run " << run;
      }
    }
  }
}

TEST(RandomStream, IsUniformAndNeighbouringSeedsAreUnrelated) {
  RandomStream a(7), b(8);
  double sum = 0, product = 0;
  std::vector<std::uint64_t> first, second;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    RandomStream c(static_cast<std::uint64_t>(i));
    const float u = a.uniform(), v = c.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    sum += u;
    product += (u - 0.5) * (v - 0.5);
  }
  EXPECT_NEAR(sum / n, 0.5, 4 * 0.2887 / std::sqrt(n));
  EXPECT_NEAR(product / n, 0, 4 / 12.0 / std::sqrt(n));
  for (int i = 0; i < 100; ++i) first.push_back(a.bits()), second.push_back(b.bits());
  for (const std::uint64_t x : second) {
    EXPECT_EQ(std::count(first.begin(), first.end(), x), 0);
  }
}

TEST(ToUnit, StaysBelowOne) {
  EXPECT_EQ(to_unit(0), 0);
  EXPECT_LT(to_unit(0xFFFFFFFFU), 1);
}

/// Calls body(u, v) at the centres of an n x n grid.
template <class Body>
void for_each_cell(int n, Body&& body) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      body((static_cast<float>(i) + 0.5F) / static_cast<float>(n),
           (static_cast<float>(j) + 0.5F) / static_cast<float>(n));
    }
  }
}

constexpr int kGrid = 500;
constexpr double kCells = double{kGrid} * kGrid;

TEST(SquareToTriangle, IsUniformInArea) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for_each_cell(kGrid, [&](float u, float v) {
    const Vec2f p = square_to_triangle(u, v);
    ASSERT_TRUE(p.x >= 0 && p.y >= 0 && p.x + p.y <= 1.000001F);
    x += p.x, y += p.y, xx += p.x * p.x, xy += p.x * p.y;
  });
  EXPECT_NEAR(x / kCells, 1.0 / 3, 1e-3);
  EXPECT_NEAR(y / kCells, 1.0 / 3, 1e-3);
  EXPECT_NEAR(xx / kCells, 1.0 / 6, 1e-3);
  EXPECT_NEAR(xy / kCells, 1.0 / 12, 1e-3);
}

TEST(SquareToDisc, IsUniformInAreaAndStaysInside) {
  double x = 0, y = 0, rr = 0, rrrr = 0, xxyy = 0;
  for_each_cell(kGrid, [&](float u, float v) {
    const Vec2f p = square_to_disc(u, v);
    const double r2 = p.x * p.x + p.y * p.y;
    ASSERT_LE(r2, 1.000001);
    x += p.x, y += p.y, rr += r2, rrrr += r2 * r2, xxyy += p.x * p.x - p.y * p.y;
  });
  EXPECT_NEAR(x / kCells, 0, 1e-3);
  EXPECT_NEAR(y / kCells, 0, 1e-3);
  EXPECT_NEAR(rr / kCells, 1.0 / 2, 1e-3);
  EXPECT_NEAR(rrrr / kCells, 1.0 / 3, 1e-3);
  EXPECT_NEAR(xxyy / kCells, 0, 1e-3);
}

TEST(SquareToDisc, CornersLieOnTheRimAndTheCentreStays) {
  for (const float u : {0.0F, 1.0F}) {
    for (const float v : {0.0F, 1.0F}) {
      const Vec2f p = square_to_disc(u, v);
      EXPECT_NEAR(p.x * p.x + p.y * p.y, 1, 1e-6);
    }
  }
  EXPECT_EQ(square_to_disc(0.5F, 0.5F), Vec2f{});
}

TEST(SquareToCosineHemisphere, HasDensityCosineOverPi) {
  double z = 0, zz = 0;
  for_each_cell(kGrid, [&](float u, float v) {
    const Vec3f d = square_to_cosine_hemisphere(u, v);
    ASSERT_NEAR(length(d), 1, 1e-5);
    ASSERT_GE(d.z, 0);
    z += d.z, zz += d.z * d.z;
  });
  EXPECT_NEAR(z / kCells, 2.0 / 3, 1e-3);
  EXPECT_NEAR(zz / kCells, 1.0 / 2, 1e-3);
}

TEST(SquareToSphere, IsUniformInSolidAngle) {
  Vec3d sum, squares;
  for_each_cell(kGrid, [&](float u, float v) {
    const Vec3f d = square_to_sphere(u, v);
    ASSERT_NEAR(length(d), 1, 1e-5);
    sum += Vec3d(d), squares += Vec3d(d * d);
  });
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(sum[i] / kCells, 0, 1e-3);
    EXPECT_NEAR(squares[i] / kCells, 1.0 / 3, 1e-3);
  }
}

}  // namespace
}  // namespace relumbre
