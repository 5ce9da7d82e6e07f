#include "relumbre/octree/geometry_unit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"
#include "relumbre/octree/full_stack.h"
#include "relumbre/octree/test_rays.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/traversal_testing.h"

namespace relumbre {
namespace {

using namespace test;

struct Log {
  std::size_t rays = 0;
  std::vector<LocationCode> visits, reads;

  void begin_ray(const GridRay&) { ++rays; }
  void visit(LocationCode code, int level) {
    EXPECT_EQ(level, level_of(code));
    visits.push_back(code);
  }
  void read(LocationCode code, int level) {
    EXPECT_EQ(level, level_of(code));
    reads.push_back(code);
  }
  void restart() { ADD_FAILURE(); }
};

/// By the definition alone: a set of nodes, a recursion, all three slabs at once.
class SlowUnit {
 public:
  SlowUnit(const VoxelSet& voxels, int depth) : depth_(depth) {
    for (const std::uint64_t voxel : voxels)
      for (LocationCode code = location_code(depth, voxel); code != 0; code = parent_of(code))
        nodes_.insert(code);
    nodes_.insert(kRootCode);
  }

  std::optional<GeometryHit> trace(const TestRay& ray, LocationCode code, Log& log) const {
    log.visit(code, level_of(code));
    const std::optional<double> t = enter(ray, code);
    if (!t) return std::nullopt;
    if (level_of(code) == depth_) return GeometryHit{code, *t};
    log.read(code, level_of(code));
    for (unsigned rank = 0; rank < 8; ++rank) {
      unsigned octant = rank;
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (ray.direction[axis] < 0) octant ^= 1U << axis;
      const LocationCode child = 8 * code + octant;
      if (!nodes_.contains(child)) continue;
      if (const auto hit = trace(ray, child, log)) return hit;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::optional<double> enter(const TestRay& ray, LocationCode code) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double size = std::ldexp(1.0, depth_ - level_of(code));
    const Cell cell = cell_of(code);
    const Vec3d lower = Vec3d(cell.x, cell.y, cell.z) * size;
    double near = -kInfinity, far = kInfinity;
    bool moves = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double o = ray.origin[axis], d = ray.direction[axis];
      if (d == 0) {
        if (o < lower[axis] || o > lower[axis] + size) return std::nullopt;
        continue;
      }
      const double a = (lower[axis] - o) / d, b = (lower[axis] + size - o) / d;
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
      moves = true;
    }
    if (!moves || near > far || far < 0 || near == kInfinity) return std::nullopt;
    return std::max(near, 0.0);
  }

  int depth_;
  std::set<LocationCode> nodes_;
};

struct Scene {
  VoxelSet voxels;
  int depth;
};

std::vector<Scene> scenes() {
  return {{shell(6), 6},
          {random_voxels(5, 400, 1), 5},
          {random_voxels(8, 900, 2), 8},
          {{0}, 1},
          {all_voxels(3), 3},
          {{}, 4}};
}

TEST(GeometryUnit, DoesWhatTheDefinitionDoes) {
  for (const auto& [voxels, depth] : scenes()) {
    const Octree octree(voxels, depth);
    const SlowUnit slow(voxels, depth);
    std::size_t hits = 0;
    for (const TestRay& ray : test_rays(depth, 5000)) {
      Log log, expected;
      const auto hit = trace_geometry_unit(octree, ray.origin, ray.direction, log);
      ASSERT_EQ(hit, slow.trace(ray, kRootCode, expected));
      ASSERT_EQ(log.visits, expected.visits);
      ASSERT_EQ(log.reads, expected.reads);
      ASSERT_EQ(log.rays, 1U);
      ASSERT_EQ(hit, trace_geometry_unit(octree, ray.origin, ray.direction));
      hits += hit.has_value();
    }
    EXPECT_EQ(hits > 10, !voxels.empty()) << hits;
  }
}

TEST(GeometryUnit, FindsTheNearestVoxelNotTheFirstInIndexOrder) {
  const VoxelSet row{morton_encode(Cell{0, 2, 2}), morton_encode(Cell{7, 2, 2})};
  const Octree octree(row, 3);
  const auto from = [&](double x, double direction) {
    return trace_geometry_unit(octree, {x, 2.5, 2.5}, {direction, 0, 0})->code;
  };
  EXPECT_EQ(cell_of(from(-1, 1)), (Cell{0, 2, 2}));
  EXPECT_EQ(cell_of(from(9, -1)), (Cell{7, 2, 2}));
}

/// Rays that go through no edge of a cell.
TEST(GeometryUnit, FindsWhatTheOtherTraversalsFindWhereNothingIsTouched) {
  for (const auto& [voxels, depth] : scenes()) {
    const Octree octree(voxels, depth);
    const double edge = std::ldexp(1.0, depth);
    RandomStream random(static_cast<std::uint64_t>(depth));
    const auto point = [&](double scale) {
      return Vec3d(random.uniform(), random.uniform(), random.uniform()) * scale;
    };
    for (int i = 0; i < 5000; ++i) {
      const Vec3d origin = point(3 * edge) - Vec3d(edge), direction = point(edge) - origin;
      const auto hit = trace_geometry_unit(octree, origin, direction);
      const auto expected = trace_full_stack(octree, GridRay(origin, direction), NoObserver{});
      ASSERT_EQ(hit.has_value(), expected.has_value());
      if (!hit) continue;
      ASSERT_EQ(cell_of(hit->code), expected->cell);
      ASSERT_NEAR(hit->t, expected->t, 1e-12);
    }
  }
}

TEST(GeometryUnit, ATouchedCornerIsAHit) {
  const Octree octree(VoxelSet{7}, 1);  // the cube of 2: its farthest cell, from (1, 1, 1)
  const Vec3d direction(1, -1, 0);
  const auto hit = trace_geometry_unit(octree, {0, 2, 1}, direction);
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->code, 15U);
  EXPECT_EQ(hit->t, 1.0);
  EXPECT_FALSE(trace_full_stack(octree, GridRay({0, 2, 1}, direction), NoObserver{}).has_value());
  EXPECT_FALSE(trace_geometry_unit(octree, {0, 2, 0.999}, direction).has_value());
}

TEST(GeometryUnit, ARayWithinAPlaneIsInTheClosedSlabWhateverTheSignOfZero) {
  const Octree octree(VoxelSet{0}, 2);
  for (const double zero : {0.0, -0.0})
    for (const double plane : {0.0, 1.0}) {
      EXPECT_TRUE(trace_geometry_unit(octree, {plane, 0.5, -1}, {zero, 0, 1}).has_value());
      EXPECT_TRUE(trace_geometry_unit(octree, {0.5, plane, -1}, {0, zero, 1}).has_value());
      EXPECT_TRUE(trace_geometry_unit(octree, {-1, 0.5, plane}, {1, 0, zero}).has_value());
      EXPECT_FALSE(trace_geometry_unit(octree, {plane, 1.5, -1}, {zero, 0, 1}).has_value());
    }
}

TEST(GeometryUnit, ChildrenAtTheSameDistanceComeByOctantXorSignMask) {
  const Octree octree(all_voxels(1), 1);
  // Along the line where four cells meet.
  EXPECT_EQ(trace_geometry_unit(octree, {1, 1, -1}, {0, 0, 1})->code, 8U);
  EXPECT_EQ(trace_geometry_unit(octree, {1, 1, 3}, {0, 0, -1})->code, 8U + 4);
  EXPECT_EQ(trace_geometry_unit(octree, {-1, 1, 1}, {1, 0, 0})->code, 8U);
  EXPECT_EQ(trace_geometry_unit(octree, {-1, -1, -1}, {1, 1, 1})->code, 8U);
  EXPECT_EQ(trace_geometry_unit(octree, {3, 3, 3}, {-1, -1, -1})->code, 8U + 7);
}

TEST(GeometryUnit, RaysThatCannotBePopTheRootAlone) {
  const Octree octree(all_voxels(2), 2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const TestRay& ray :
       {TestRay{{1, 1, 1}, {0, 0, 0}}, TestRay{{nan, 1, 1}, {1, 0, 0}},
        TestRay{{1, 1, 1}, {1, nan, 0}}, TestRay{{-1, -1, -1}, {0, 0, -0.0}}}) {
    Log log;
    EXPECT_FALSE(trace_geometry_unit(octree, ray.origin, ray.direction, log).has_value());
    EXPECT_EQ(log.visits, std::vector<LocationCode>{kRootCode});
    EXPECT_TRUE(log.reads.empty());
  }
}

}  // namespace
}  // namespace relumbre
