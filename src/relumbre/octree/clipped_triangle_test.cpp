#include "relumbre/octree/clipped_triangle.h"

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

std::array<Vec3d, 3> random_triangle(RandomStream& random) {
  std::array<Vec3d, 3> t;
  for (Vec3d& p : t) p = Vec3d(Vec3f(random.uniform(), random.uniform(), random.uniform())) * 4.0;
  return t;
}
double area(const std::array<Vec3d, 3>& t) { return length(cross(t[1] - t[0], t[2] - t[0])) / 2; }

TEST(ClippedTriangle, PartsInAGridsCellsMakeTheWhole) {
  RandomStream random(9);
  for (int i = 0; i < 200; ++i) {
    const auto triangle = random_triangle(random);
    double sum = 0;
    Vec3d moment;
    for (int cell = 0; cell < 64; ++cell) {
      const Vec3d lower(cell % 4, cell / 4 % 4, cell / 16);
      const ClippedTriangle part = clip_to_box(triangle, lower, lower + Vec3d(1));
      sum += part.area;
      moment += part.centroid * part.area;
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_GE(part.centroid[a], lower[a] - 1e-9);
        EXPECT_LE(part.centroid[a], lower[a] + 1 + 1e-9);
      }
    }
    EXPECT_NEAR(sum, area(triangle), 1e-9);
    EXPECT_LT(length(moment - (triangle[0] + triangle[1] + triangle[2]) * (sum / 3)), 1e-9);
  }
}

TEST(ClippedTriangle, InsideTheBoxNothingIsCut) {
  RandomStream random(10);
  const auto triangle = random_triangle(random);
  const ClippedTriangle whole = clip_to_box(triangle, Vec3d(-1), Vec3d(5));
  EXPECT_DOUBLE_EQ(whole.area, area(triangle));
  EXPECT_LT(length(whole.centroid * 3.0 - triangle[0] - triangle[1] - triangle[2]), 1e-12);
}

TEST(ClippedTriangle, WhatOnlyTouchesHasNoAreaButAPlace) {
  const std::array<Vec3d, 3> wall{Vec3d(1, 0, 0), Vec3d(1, 1, 0), Vec3d(1, 0, 1)};
  EXPECT_DOUBLE_EQ(clip_to_box(wall, Vec3d(0), Vec3d(1)).area, 0.5);  // in the face of both cells
  EXPECT_DOUBLE_EQ(clip_to_box(wall, Vec3d(1, 0, 0), Vec3d(2, 1, 1)).area, 0.5);
  const ClippedTriangle corner = clip_to_box(wall, Vec3d(1, 1, 0), Vec3d(2, 2, 1));
  EXPECT_EQ(corner.area, 0);
  EXPECT_EQ(corner.centroid, Vec3d(1, 1, 0));
}

}  // namespace
}  // namespace relumbre
