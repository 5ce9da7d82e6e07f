#include "relumbre/scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

/// Sum of the triangles' areas, positive where they face +z, and the sum of their absolute areas.
/// Both are the polygon's area exactly if the triangles cover it once.
struct Areas {
  double signed_sum = 0, absolute_sum = 0;
};

Areas areas(std::span<const Vec3f> corners) {
  std::vector<Index3> triangles;
  triangulate_polygon(corners, triangles);
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  Areas result;
  for (const auto& [a, b, c] : triangles) {
    const double area =
        cross(Vec3d(corners[b]) - Vec3d(corners[a]), Vec3d(corners[c]) - Vec3d(corners[a])).z / 2;
    result.signed_sum += area;
    result.absolute_sum += std::abs(area);
  }
  return result;
}

void expect_covered_once(const std::vector<Vec3f>& corners, double area) {
  const Areas found = areas(corners);
  EXPECT_NEAR(found.signed_sum, area, 1e-6);
  EXPECT_NEAR(found.absolute_sum, area, 1e-6);
}

TEST(Triangulate, ConvexPolygons) {
  for (const std::size_t n : {3U, 4U, 5U, 17U}) {
    std::vector<Vec3f> corners;
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      corners.push_back(Vec3f(Vec3d(std::cos(angle), std::sin(angle), 0)));
    }
    expect_covered_once(corners, 0.5 * static_cast<double>(n) *
                                     std::sin(2 * std::numbers::pi / static_cast<double>(n)));
  }
}

TEST(Triangulate, ConcaveQuadrilateralsWhereverTheyStart) {
  std::vector<Vec3f> arrow = {{0, 0, 0}, {2, -1, 0}, {0, 3, 0}, {-2, -1, 0}};
  for (int start = 0; start < 4; ++start) {
    std::rotate(arrow.begin(), arrow.begin() + 1, arrow.end());
    expect_covered_once(arrow, 6);
  }
}

TEST(Triangulate, LettersAndCombs) {
  expect_covered_once({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, 5);
  std::vector<Vec3f> comb = {{0, 0, 0}, {20, 0, 0}};
  for (int tooth = 9; tooth >= 0; --tooth) {
    const auto x = static_cast<float>(2 * tooth);
    comb.insert(comb.end(), {{x + 2, 1, 0}, {x + 1, 1, 0}, {x + 1, 5, 0}, {x, 5, 0}});
  }
  expect_covered_once(comb, 20 + 10 * 4);
}

TEST(Triangulate, ASeamToAHoleIsWalkedTwice) {
  expect_covered_once({{0, 0, 0},
                       {4, 0, 0},
                       {4, 4, 0},
                       {0, 4, 0},
                       {0, 0, 0},
                       {1, 1, 0},
                       {1, 3, 0},
                       {3, 3, 0},
                       {3, 1, 0},
                       {1, 1, 0}},
                      12);
}

TEST(Triangulate, NonsenseStillEnds) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Index3> triangles;
  triangulate_polygon(std::vector<Vec3f>(2), triangles);
  EXPECT_TRUE(triangles.empty());
  (void)areas(std::vector<Vec3f>(7));
  (void)areas(std::vector<Vec3f>(9, Vec3f(nan)));
  (void)areas(std::vector<Vec3f>(5000));
  (void)areas(std::vector<Vec3f>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {2, nan, 1}});
}

}  // namespace
}  // namespace relumbre
