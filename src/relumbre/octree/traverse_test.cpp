#include "relumbre/octree/traverse.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/test_rays.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/traversal_testing.h"

namespace relumbre {
namespace {

using test::all_traversals, test::all_voxels, test::name_of, test::random_voxels, test::shell,
    test::test_rays, test::TestRay, test::VoxelSet;
using Kind = Traversal::Kind;

/// A walk of all voxels, by the definition of a hit alone.
std::optional<VoxelHit> slow_trace(const std::vector<Cell>& voxels, const GridRay& ray) {
  std::optional<VoxelHit> nearest;
  for (const Cell& cell : voxels) {
    const std::optional<VoxelHit> hit = intersect_voxel(ray, cell);
    if (hit && (!nearest || hit->t < nearest->t)) nearest = hit;
  }
  return nearest;
}

std::vector<Cell> cells_of(const VoxelSet& voxels) {
  std::vector<Cell> cells(voxels.size());
  morton_decode(voxels, cells);
  return cells;
}

/// Every traversal of every ray against the walk of all voxels. Returns the number of hits.
std::size_t expect_same_hits(const VoxelSet& voxels, int depth, const std::vector<TestRay>& rays) {
  SCOPED_TRACE(testing::Message() << voxels.size() << " voxels, depth " << depth);
  const Octree octree(voxels, depth);
  const std::vector<Cell> cells = cells_of(voxels);
  std::atomic<std::size_t> hits = 0, wrong = 0;
  parallel_for(0, rays.size(), 64, [&](std::size_t i) {
    const GridRay ray(rays[i].origin, rays[i].direction);
    const std::optional<VoxelHit> expected = slow_trace(cells, ray);
    hits += expected ? 1 : 0;
    for (const Traversal& traversal : all_traversals()) {
      if (trace(octree, ray, traversal) == expected || wrong++ > 0) continue;
      const Vec3d o = rays[i].origin, d = rays[i].direction;
      ADD_FAILURE() << name_of(traversal) << " from " << o.x << " " << o.y << " " << o.z
                    << " towards " << d.x << " " << d.y << " " << d.z;
    }
  });
  EXPECT_EQ(wrong, 0U);
  return hits;
}

TEST(Traversal, EveryKindFindsTheVoxelThatAWalkOfAllVoxelsFinds) {
  for (int depth = 1; depth <= 8; ++depth)
    for (const std::size_t count : {3U, 40U, 300U}) {
      const VoxelSet voxels = random_voxels(depth, count, static_cast<std::uint64_t>(depth));
      expect_same_hits(voxels, depth, test_rays(depth, 10'000));
    }
}

TEST(Traversal, EveryKindFindsTheShell) {
  for (int depth = 2; depth <= 5; ++depth) {
    const std::size_t rays = 60'000U >> (2 * depth - 2);
    EXPECT_GE(expect_same_hits(shell(depth), depth, test_rays(depth, rays)), rays / 5);
  }
  for (const auto& [depth, rays] : {std::pair<int, std::size_t>{6, 2000}, {7, 1000}, {8, 500}})
    EXPECT_GE(expect_same_hits(shell(depth), depth, test_rays(depth, rays)), rays / 5);
}

TEST(Traversal, EveryKindFindsTheFirstCellOfAFullGrid) {
  for (int depth = 1; depth <= 4; ++depth)
    EXPECT_GE(expect_same_hits(all_voxels(depth), depth, test_rays(depth, 4000)), 1000U);
}

TEST(Traversal, EveryKindFindsASingleVoxelAnywhere) {
  for (int depth = 1; depth <= 8; ++depth) {
    const std::uint64_t last = (std::uint64_t{1} << 3 * depth) - 1;
    for (const std::uint64_t voxel : {std::uint64_t{0}, last, last / 2, last / 7 * 3})
      expect_same_hits({voxel}, depth, test_rays(depth, 3000));
  }
}

TEST(Traversal, EveryKindFindsFarVoxelsAtTheGreatestDepth) {
  const VoxelSet voxels = random_voxels(kMaxDepth, 300, 9);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-0.25, 1.25);
  std::vector<TestRay> rays;
  for (const Cell& cell : cells_of(voxels)) {  // at random rays would hit nothing
    const Vec3d target(cell.x + uniform(random), cell.y + uniform(random),
                       cell.z + uniform(random));
    const Vec3d origin(uniform(random), uniform(random), uniform(random));
    rays.push_back({origin * 1048576.0, target - origin * 1048576.0});
  }
  EXPECT_GE(expect_same_hits(voxels, kMaxDepth, rays), 60U);
}

/// The rays of a family that starts at lattice points around and in the cube.
std::vector<TestRay> lattice_rays(int depth, const std::vector<Vec3d>& directions, double step) {
  const double edge = std::ldexp(1.0, depth);
  std::vector<TestRay> rays;
  for (double z = -1; z <= edge + 1; z += step)
    for (double y = -1; y <= edge + 1; y += step)
      for (const double x : {-2.0, 0.0, edge / 2 - 0.5, edge / 2, edge, edge + 1})
        for (const Vec3d& direction : directions) {
          rays.push_back({{x, y, z}, direction});
          rays.push_back({{y, z, x}, {direction.y, direction.z, direction.x}});
          rays.push_back({{z, x, y}, {direction.z, direction.x, direction.y}});
        }
  return rays;
}

TEST(Traversal, AlongAxesInFacesAndThroughCellsEveryKindIsExact) {
  std::vector<Vec3d> directions;
  for (const double x : {1.0, -1.0})
    for (const double zero : {0.0, -0.0, 5e-324, -5e-324}) directions.push_back({x, zero, zero});
  const std::vector<TestRay> rays = lattice_rays(3, directions, 0.5);
  for (const VoxelSet& voxels : {shell(3), random_voxels(3, 60, 1), all_voxels(3)})
    EXPECT_GE(expect_same_hits(voxels, 3, rays), rays.size() / 20);
}

TEST(Traversal, AlongDiagonalsThroughEdgesAndCornersEveryKindIsExact) {
  std::vector<Vec3d> directions;
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double z : {1.0, 0.0, -1.0, 2.0}) directions.push_back({x, y, z});
  const std::vector<TestRay> rays = lattice_rays(3, directions, 0.5);
  for (const VoxelSet& voxels : {shell(3), random_voxels(3, 60, 2), all_voxels(3)})
    EXPECT_GE(expect_same_hits(voxels, 3, rays), rays.size() / 20);
}

TEST(Traversal, OfAnEmptyTreeOrOfARayThatIsNotFiniteFindsNothing) {
  const Octree empty({}, 5), full(all_voxels(2), 2);
  for (const Traversal& traversal : all_traversals()) {
    EXPECT_FALSE(trace(empty, GridRay({1, 2, 3}, {1, 1, 1}), traversal));
    EXPECT_FALSE(trace(full, GridRay({1, NAN, 3}, {1, 1, 1}), traversal));
    EXPECT_FALSE(trace(full, GridRay({1, 1, 1}, {1, INFINITY, 1}), traversal));
  }
}

TEST(Traversal, AShortStackWithoutNodesIsRefused) {
  const Octree octree(shell(3), 3);
  for (const int nodes : {0, -1})
    EXPECT_THROW((void)trace(octree, GridRay({0, 0, 0}, {1, 1, 1}), {Kind::kShortStack, nodes}),
                 ValueError);
}

}  // namespace
}  // namespace relumbre
