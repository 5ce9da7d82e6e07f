#include "relumbre/octree/grid_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "relumbre/octree/test_rays.h"
#include "relumbre/octree/test_voxels.h"

namespace relumbre {
namespace {

using test::TestRay, test::TestRays;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(GridRay, HitsTheCellAheadWhereItEnters) {
  const GridRay ray({-3, 0.5, 0.25}, {2, 0, 0});
  EXPECT_EQ(intersect_voxel(ray, {4, 0, 0}), (VoxelHit{{4, 0, 0}, 3.5, 0}));
  EXPECT_EQ(intersect_voxel(ray, {4, 1, 0}), std::nullopt);
  EXPECT_EQ(intersect_voxel(GridRay({9, 0.5, 0.5}, {2, 0, 0}), {4, 0, 0}), std::nullopt);
}

TEST(GridRay, StartsWithinACellAtZeroThroughNoFace) {
  const GridRay ray({4.5, 4.5, 4.5}, {1, 2, -3});
  EXPECT_EQ(intersect_voxel(ray, {4, 4, 4}), (VoxelHit{{4, 4, 4}, 0, -1}));
}

TEST(GridRay, StartsOnAFaceThroughThatFace) {
  EXPECT_EQ(intersect_voxel(GridRay({4.5, 4, 4.5}, {0, 1, 0}), {4, 4, 4}),
            (VoxelHit{{4, 4, 4}, 0, 1}))
      << "not where it is parallel to the others";
  EXPECT_EQ(intersect_voxel(GridRay({4.5, 4, 4.5}, {0.5, 1, 0.5}), {4, 4, 4})->axis, 1);
  EXPECT_EQ(intersect_voxel(GridRay({4.5, 5, 4.5}, {0.5, -1, 0.5}), {4, 4, 4})->axis, 1);
  EXPECT_EQ(intersect_voxel(GridRay({4.5, 5, 4.5}, {0.5, 1, 0.5}), {4, 4, 4}), std::nullopt);
}

TEST(GridRay, TouchingIsNotPiercing) {
  // Through the edge x = y = 1 and the corner (1,1,1) of the cell (0,0,0).
  EXPECT_FALSE(GridRay({0, 2, 0.5}, {1, -1, 0}).interval({0, 0, 0}, 1).is_pierced());
  EXPECT_FALSE(GridRay({0, 2, 1}, {1, -1, 0}).interval({0, 0, 0}, 1).is_pierced());
  EXPECT_TRUE(GridRay({0, 1.99, 0.5}, {1, -1, 0}).interval({0, 0, 0}, 1).is_pierced());
}

TEST(GridRay, InAPlaneBelongsToTheUpperCell) {
  for (const double zero : {0.0, -0.0, 1e-310, -1e-310, 5e-324}) {
    const GridRay ray({3, -1, 0.5}, {zero, 1, 0});
    EXPECT_TRUE(intersect_voxel(ray, {3, 0, 0})) << zero;
    EXPECT_FALSE(intersect_voxel(ray, {2, 0, 0})) << zero;
    EXPECT_TRUE(ray.interval({2, 0, 0}, 2).is_pierced()) << zero;
    EXPECT_EQ(ray.sign_mask(), 0U);
  }
  EXPECT_TRUE(intersect_voxel(GridRay({0, -1, -0.0}, {0, 1, 0}), {0, 0, 0}));
  EXPECT_FALSE(intersect_voxel(GridRay({8, -1, 0}, {0, 1, 0}), {7, 0, 0}));
  EXPECT_FALSE(intersect_voxel(GridRay({-1e-320, -1, 0}, {0, 1, 0}), {0, 0, 0}));
}

TEST(GridRay, NoDirectionHitsTheCellOfItsOrigin) {
  const GridRay ray({3.5, 2, 1.25}, {0, -0.0, 0});
  EXPECT_EQ(intersect_voxel(ray, {3, 2, 1}), (VoxelHit{{3, 2, 1}, 0, -1}));
  EXPECT_FALSE(intersect_voxel(ray, {3, 1, 1}));
}

TEST(GridRay, NotFiniteHitsNothing) {
  for (const double bad : {kNan, kInfinity, -kInfinity})
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3d origin(0.5), direction(1.0);
      origin[axis] = bad;
      EXPECT_FALSE(GridRay(origin, {1, 1, 1}).interval({0, 0, 0}, 8).is_pierced());
      direction[axis] = bad;
      EXPECT_FALSE(GridRay({0.5, 0.5, 0.5}, direction).interval({0, 0, 0}, 8).is_pierced());
    }
}

TEST(GridRay, ExtremesNeverGiveNan) {
  constexpr double kMax = std::numeric_limits<double>::max();
  const double values[] = {0.0, -0.0, 5e-324, -1e-308, 1e-308, 1.0, 1e300, kMax, -kMax};
  for (const double o : values)
    for (const double d : values)
      for (const double k : {0.0, 1.0, 1048576.0}) {
        const Vec3d t = GridRay(Vec3d(o), Vec3d(d)).t(Vec3d(k));
        EXPECT_FALSE(std::isnan(t.x)) << o << " " << d << " " << k;
      }
}

/// Whether the part of the ray with t > 0 within the cell has a length, in integers: the origin is
/// counted in halves, each slope is 0, ±1 or ±2, and t in quarters.
bool pierces_exactly(const std::array<int, 3>& halves, const std::array<int, 3>& slopes,
                     const std::array<int, 3>& cell) {
  int enter = 0, exit = std::numeric_limits<int>::max();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int below = 2 * cell[axis] - halves[axis], above = below + 2;
    if (slopes[axis] == 0) {
      if (below > 0 || above <= 0) return false;
      continue;
    }
    const int a = 2 * below / slopes[axis], b = 2 * above / slopes[axis];
    enter = std::max(enter, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  return enter < exit;
}

TEST(GridRay, IsExactWhereTheArithmeticIs) {
  std::mt19937_64 random(7);
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  int pierced = 0;
  for (int i = 0; i < 300'000; ++i) {
    std::array<int, 3> halves{}, slopes{}, cell{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      halves[axis] = pick(-6, 14), slopes[axis] = pick(-2, 2), cell[axis] = pick(0, 3);
    const GridRay ray(Vec3d(halves[0], halves[1], halves[2]) * 0.5,
                      Vec3d(slopes[0], slopes[1], slopes[2]));
    const bool expected = pierces_exactly(halves, slopes, cell);
    const Cell corner{static_cast<std::uint32_t>(cell[0]), static_cast<std::uint32_t>(cell[1]),
                      static_cast<std::uint32_t>(cell[2])};
    ASSERT_EQ(intersect_voxel(ray, corner).has_value(), expected);
    pierced += expected ? 1 : 0;
  }
  EXPECT_GT(pierced, 1000);
}

TEST(GridRay, IntervalsOfCellsLieWithinThoseOfTheCellsAround) {
  TestRays rays(6, 1);
  std::mt19937_64 random(2);
  for (int i = 0; i < 100'000; ++i) {
    const TestRay r = rays.next();
    const GridRay ray(r.origin, r.direction);
    const Cell cell = morton_decode(random() >> (64 - 18));
    RayInterval inner = ray.interval(cell, 1);
    for (std::uint32_t size = 2; size <= 64; size *= 2) {
      const std::uint32_t keep = ~(size - 1);
      const RayInterval outer = ray.interval({cell.x & keep, cell.y & keep, cell.z & keep}, size);
      ASSERT_LE(outer.enter, inner.enter);
      ASSERT_GE(outer.exit, inner.exit);
      inner = outer;
    }
  }
}

TEST(GridRay, PiercedOctantsPartitionTheirParentInOrderOfTheSignMask) {
  TestRays rays(1, 3);
  for (int i = 0; i < 100'000; ++i) {
    const TestRay r = rays.next();
    const GridRay ray(r.origin, r.direction);
    const RayInterval whole = ray.interval({0, 0, 0}, 2);
    if (!whole.is_pierced()) continue;
    double now = whole.enter;
    for (unsigned rank = 0; rank < 8; ++rank) {
      const unsigned octant = rank ^ ray.sign_mask();
      const RayInterval part = ray.interval(morton_decode(octant), 1);
      if (!part.is_pierced()) continue;
      ASSERT_EQ(part.enter, now);
      ASSERT_EQ(ray.octant_at({1, 1, 1}, now), octant);
      now = part.exit;
    }
    ASSERT_EQ(now, whole.exit);
  }
}

}  // namespace
}  // namespace relumbre
