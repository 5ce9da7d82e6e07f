#include "relumbre/octree/tree_cast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/octree/cast_kernels.h"
#include "relumbre/octree/test_rays.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/traversal_testing.h"
#include "relumbre/octree/voxel_tree_builder.h"

namespace relumbre {
namespace {

using test::all_voxels, test::random_voxels, test::shell;
using test::test_rays, test::TestRay, test::VoxelSet;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

VoxelTree tree_of(const VoxelSet& voxels, int depth) {
  return build_tree({}, static_cast<unsigned>(depth), Separating::k26,
                    test::blocks_of(voxels, true));
}

std::vector<CastRay> cast_rays(const std::vector<TestRay>& rays) {
  std::vector<CastRay> result;
  for (const TestRay& ray : rays) result.push_back({ray.origin, ray.direction, kInfinity});
  return result;
}

std::vector<TreeHit> cast_all(const VoxelTree& tree, const std::vector<CastRay>& rays) {
  std::vector<TreeHit> hits(rays.size());
  cast(tree, rays, hits);
  return hits;
}

std::vector<TreeHit> cast_one_by_one(const VoxelTree& tree, const std::vector<CastRay>& rays) {
  std::vector<TreeHit> hits;
  for (const CastRay& ray : rays) hits.push_back(cast(tree, ray));
  return hits;
}

/// A walk of all voxels and of all nodes, by the definition of a hit alone.
TreeHit slow_cast(const VoxelTree& tree, const VoxelSet& voxels, const CastRay& ray) {
  const GridRay grid_ray(ray.origin, ray.direction);
  TreeHit nearest;
  for (unsigned level = 0; level < tree.levels(); ++level) {  // the largest first
    const std::uint32_t edge = tree.child_edge(level);
    if (edge > 1 && !(ray.spread > 0)) continue;
    for (const std::uint64_t code : voxels) {
      Cell lower = morton_decode(code);
      lower = {lower.x / edge * edge, lower.y / edge * edge, lower.z / edge * edge};
      const auto hit = intersect_voxel(grid_ray, lower, edge);
      if (!hit || !(hit->t < ray.t_max) || (edge > 1 && !(edge <= ray.spread * hit->t))) continue;
      if (!nearest || hit->t < nearest.voxel.t)
        nearest = {*hit, *tree.find(morton_decode(code), level)};
    }
  }
  return nearest;
}

void expect_equal(const std::vector<TreeHit>& hits, const std::vector<TreeHit>& expected,
                  const std::vector<CastRay>& rays, const std::string& what) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i] == expected[i] || wrong++ > 0) continue;
    const Vec3d o = rays[i].origin, d = rays[i].direction;
    ADD_FAILURE() << what << ": ray " << i << " from " << o.x << " " << o.y << " " << o.z
                  << " towards " << d.x << " " << d.y << " " << d.z;
  }
  EXPECT_EQ(wrong, 0U) << what;
}

/// One by one and in a batch, against the walk of all voxels. Returns the number of hits.
std::size_t expect_exact(const VoxelSet& voxels, int depth, const std::vector<CastRay>& rays) {
  SCOPED_TRACE(testing::Message() << voxels.size() << " voxels, depth " << depth);
  const VoxelTree tree = tree_of(voxels, depth);
  std::vector<TreeHit> expected;
  for (const CastRay& ray : rays) expected.push_back(slow_cast(tree, voxels, ray));
  expect_equal(cast_one_by_one(tree, rays), expected, rays, "one by one");
  expect_equal(cast_all(tree, rays), expected, rays, "batch");
  for (const CastKernel& kernel : available_cast_kernels()) {
    std::vector<TreeHit> hits(rays.size());
    kernel.cast(tree, rays, hits);
    expect_equal(hits, expected, rays, std::string(kernel.name));
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(expected, [](const TreeHit& hit) { return bool{hit}; }));
}

TEST(TreeCast, FindsTheVoxelThatAWalkOfAllVoxelsFinds) {
  for (int depth = 1; depth <= 9; ++depth)
    for (const std::size_t count : {3U, 40U, 300U})
      expect_exact(random_voxels(depth, count, static_cast<std::uint64_t>(depth)), depth,
                   cast_rays(test_rays(depth, 5'000)));
}

TEST(TreeCast, FindsTheShell) {
  for (int depth = 2; depth <= 5; ++depth) {
    const std::size_t rays = 60'000U >> (2 * depth - 2);
    EXPECT_GE(expect_exact(shell(depth), depth, cast_rays(test_rays(depth, rays))), rays / 5);
  }
}

TEST(TreeCast, FindsTheFirstCellOfAFullGrid) {
  for (int depth = 1; depth <= 4; ++depth)
    EXPECT_GE(expect_exact(all_voxels(depth), depth, cast_rays(test_rays(depth, 4000))), 1000U);
}

TEST(TreeCast, FindsASingleVoxelAnywhere) {
  expect_exact({0}, 0, cast_rays(test_rays(1, 3000)));
  for (int depth = 1; depth <= 12; ++depth) {
    const std::uint64_t last = (std::uint64_t{1} << 3 * depth) - 1;
    for (const std::uint64_t voxel : {std::uint64_t{0}, last, last / 2, last / 7 * 3})
      expect_exact({voxel}, depth, cast_rays(test_rays(depth, 3000)));
  }
}

/// The rays of a family that starts at lattice points around and in the cube.
std::vector<CastRay> lattice_rays(double edge, const std::vector<Vec3d>& directions) {
  std::vector<CastRay> rays;
  for (double z = -1; z <= edge + 1; z += 0.5)
    for (double y = -1; y <= edge + 1; y += 0.5)
      for (const double x : {-2.0, 0.0, edge / 2 - 0.5, edge / 2, edge, edge + 1})
        for (const Vec3d& d : directions) {
          rays.push_back({{x, y, z}, d, kInfinity});
          rays.push_back({{y, z, x}, {d.y, d.z, d.x}, kInfinity});
          rays.push_back({{z, x, y}, {d.z, d.x, d.y}, kInfinity});
        }
  return rays;
}

TEST(TreeCast, AlongAxesInFacesAndThroughCellsIsExact) {
  std::vector<Vec3d> directions;
  for (const double x : {1.0, -1.0})
    for (const double zero : {0.0, -0.0, 5e-324, -5e-324}) directions.push_back({x, zero, zero});
  const std::vector<CastRay> rays = lattice_rays(8, directions);
  for (const VoxelSet& voxels : {shell(3), random_voxels(3, 60, 1), all_voxels(3)})
    EXPECT_GE(expect_exact(voxels, 3, rays), rays.size() / 20);
}

TEST(TreeCast, AlongDiagonalsThroughEdgesAndCornersIsExact) {
  std::vector<Vec3d> directions;
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double z : {1.0, 0.0, -1.0, 2.0}) directions.push_back({x, y, z});
  const std::vector<CastRay> rays = lattice_rays(8, directions);
  for (const VoxelSet& voxels : {shell(3), random_voxels(3, 60, 2), all_voxels(3)})
    EXPECT_GE(expect_exact(voxels, 3, rays), rays.size() / 20);
}

TEST(TreeCast, AgreesWithTheTraversalsOfTheWords) {
  for (int depth = 5; depth <= 10; ++depth) {
    const VoxelSet voxels = depth < 8 ? shell(depth) : random_voxels(depth, 400'000, 5);
    const Octree octree(voxels, depth);
    const VoxelTree tree = tree_of(voxels, depth);
    const std::vector<CastRay> rays = cast_rays(test_rays(depth, 30'000));
    const std::vector<TreeHit> hits = cast_all(tree, rays);
    expect_equal(hits, cast_one_by_one(tree, rays), rays, "batch");
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto expected = trace(octree, GridRay(rays[i].origin, rays[i].direction), {});
      wrong += (expected ? TreeHit{*expected, hits[i].child} : TreeHit{}) != hits[i];
    }
    EXPECT_EQ(wrong, 0U) << depth;
  }
}

/// Pencils of rays: groups of neighbours that a beam bounds.
std::vector<CastRay> pencils(int depth, std::size_t groups) {
  const double edge = std::ldexp(1.0, depth);
  RandomStream random(groups);
  const auto within = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random.uniform());
  };
  const auto point = [&](double low, double high) {
    return Vec3d(within(low, high), within(low, high), within(low, high));
  };
  std::vector<CastRay> rays;
  for (std::size_t group = 0; group < groups; ++group) {
    const Vec3d eye = group % 3 == 0 ? point(0, edge) : point(-edge, 2 * edge);
    const Vec3d target = point(0, edge);
    const double wide = group % 2 == 0 ? edge / 50 : 2, apart = group % 5 == 0 ? wide : 0;
    for (int i = 0; i < 64; ++i) {
      const Vec3d from = eye + point(-apart, apart);
      Vec3d direction = target + point(-wide, wide) - from;
      if (group % 7 == 0) direction = {0, direction.y, group % 2 == 0 ? 0 : direction.z};
      rays.push_back({from, direction, i % 9 == 0 ? within(0, 2) : kInfinity});
    }
  }
  return rays;
}

TEST(TreeCast, NeighboursThatGoTheSameWayAreExact) {
  for (int depth = 3; depth <= 7; ++depth) {
    const VoxelSet voxels = depth < 6 ? shell(depth) : random_voxels(depth, 2000, 7);
    EXPECT_GE(expect_exact(voxels, depth, pencils(depth, 100)), 300U);
  }
  const VoxelSet voxels = shell(9);
  const VoxelTree tree = tree_of(voxels, 9);
  const std::vector<CastRay> rays = pencils(9, 1000);
  const std::vector<TreeHit> expected = cast_one_by_one(tree, rays);
  for (const CastKernel& kernel : available_cast_kernels()) {
    std::vector<TreeHit> hits(rays.size());
    kernel.cast(tree, rays, hits);
    expect_equal(hits, expected, rays, std::string(kernel.name));
  }
}

TEST(TreeCast, VoxelsFromTMaxOnAreNotHit) {
  std::vector<CastRay> rays = cast_rays(test_rays(4, 4000));
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i].t_max = static_cast<double>(i % 40) * 0.5;
  rays[1].t_max = NAN, rays[2].t_max = -1;
  EXPECT_GE(expect_exact(shell(4), 4, rays), 200U);
  const VoxelTree tree = tree_of({0}, 0);
  EXPECT_TRUE(cast(tree, {{-3, 0.5, 0.5}, {1, 0, 0}, std::nextafter(3.0, 4)}));
  EXPECT_FALSE(cast(tree, {{-3, 0.5, 0.5}, {1, 0, 0}, 3}));
}

/// Footprints from a fraction of a voxel to the whole cube.
void widen(std::vector<CastRay>& rays, double edge) {
  RandomStream random(rays.size());
  for (CastRay& ray : rays) {
    const double distance = length(ray.origin - Vec3d(edge / 2)) / length(ray.direction);
    ray.spread = std::exp2(static_cast<double>(random.uniform()) * 12 - 4) / distance;
  }
  rays[0].spread = kInfinity, rays[1].spread = NAN, rays[2].spread = -1;
}

TEST(TreeCast, NodesWithinTheFootprintAreHitAsTheyAre) {
  for (int depth = 2; depth <= 9; ++depth) {
    std::vector<CastRay> rays = cast_rays(test_rays(depth, 4'000));
    widen(rays, std::ldexp(1.0, depth));
    EXPECT_GE(expect_exact(random_voxels(depth, 100, 9), depth, rays), 200U);
    if (depth <= 5) expect_exact(shell(depth), depth, rays);
    const VoxelTree tree = tree_of(random_voxels(depth, 100, 9), depth);
    const auto is_node = [&](const TreeHit& h) { return h && h.child.level + 1 < tree.levels(); };
    EXPECT_GE(std::ranges::count_if(cast_all(tree, rays), is_node), depth > 2 ? 100 : 0);
  }
}

TEST(TreeCast, NeighboursHitNodesWithinTheirFootprint) {
  for (int depth = 4; depth <= 9; ++depth) {
    std::vector<CastRay> rays = pencils(depth, 100);
    widen(rays, std::ldexp(1.0, depth));
    expect_exact(random_voxels(depth, 100, 9), depth, rays);
    for (std::size_t i = 0; i < rays.size(); ++i)  // one footprint a pencil
      rays[i].spread = rays[i - i % 64].spread;
    EXPECT_GE(expect_exact(random_voxels(depth, 100, 9), depth, rays), 300U);
  }
}

TEST(TreeCast, TheMeanOfANodeIsFound) {
  const VoxelSet voxels = random_voxels(6, 3000, 4);
  const VoxelTree tree = tree_of(voxels, 6);
  const TreeHit hit = cast(tree, {{-100, 30.5, 30.5}, {1, 0, 0}, kInfinity, 16.0 / 100});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit.child.level, 0U);
  EXPECT_EQ(hit.voxel.cell, (Cell{0, 16, 16}));
  EXPECT_EQ(hit.child.bit, 6U);  // y and z of the root's octant, x of neither
  const std::uint64_t below = VoxelTree::rank(tree.nodes(0)[0].mask, 6);
  EXPECT_EQ(&tree.value(hit.child), &tree.node_values(1)[below]);
}

TEST(TreeCast, TellsWhereTheTreeHasTheVoxel) {
  const VoxelSet voxels = random_voxels(6, 3000, 4);
  const VoxelTree tree = tree_of(voxels, 6);
  std::size_t hits = 0;
  for (const TreeHit& hit : cast_all(tree, cast_rays(test_rays(6, 2000)))) {
    if (!hit) continue;
    EXPECT_EQ(tree.value(hit.child), test::value_of(morton_encode(hit.voxel.cell)));
    ++hits;
  }
  EXPECT_GE(hits, 100U);
}

TEST(TreeCast, BatchesOfAnySizeAreTheSame) {
  const VoxelTree tree = tree_of(shell(6), 6);
  const std::vector<CastRay> rays = cast_rays(test_rays(6, 9001));
  const std::vector<TreeHit> expected = cast_one_by_one(tree, rays);
  for (const std::size_t count : {0U, 1U, 2U, 7U, 8U, 9U, 63U, 64U, 65U, 1023U, 4097U, 9001U}) {
    std::vector<TreeHit> hits(count);
    cast(tree, std::span(rays).first(count), hits);
    EXPECT_EQ(hits, std::vector<TreeHit>(expected.begin(),
                                         expected.begin() + static_cast<std::ptrdiff_t>(count)));
  }
  std::vector<TreeHit> short_of_one(rays.size() - 1);
  EXPECT_THROW(cast(tree, rays, short_of_one), ShapeError);
}

TEST(TreeCast, OfNoTreeOrOfARayThatIsNotFiniteFindsNothing) {
  const VoxelTree full = tree_of(all_voxels(2), 2);
  const std::vector<CastRay> rays = {{{1, NAN, 3}, {1, 1, 1}, kInfinity},
                                     {{1, 1, 1}, {1, INFINITY, 1}, kInfinity},
                                     {{1e300, 1, 1}, {-1, 0, 0}, kInfinity}};
  for (const TreeHit& hit : cast_all(full, rays)) EXPECT_FALSE(hit);
  for (const TreeHit& hit : cast_one_by_one(full, rays)) EXPECT_FALSE(hit);
  EXPECT_FALSE(cast(VoxelTree(), {{0.5, 0.5, 0.5}, {1, 1, 1}}));
  EXPECT_FALSE(cast_all(VoxelTree(), {{{0.5, 0.5, 0.5}, {1, 1, 1}, kInfinity}})[0]);
}

}  // namespace
}  // namespace relumbre
