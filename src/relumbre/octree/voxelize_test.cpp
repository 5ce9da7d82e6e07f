#include "relumbre/octree/voxelize.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/octree/brick.h"
#include "relumbre/octree/morton.h"

namespace relumbre {
namespace {

TriangleMesh random_mesh(std::size_t triangles, float size) {
  RandomStream random(triangles);
  TriangleMesh mesh;
  for (std::size_t t = 0; t < triangles; ++t) {
    const Vec3f at(random.uniform(), random.uniform(), random.uniform());
    for (int i = 0; i < 3; ++i) {
      mesh.positions.push_back(at +
                               Vec3f(random.uniform(), random.uniform(), random.uniform()) * size);
    }
    const auto first = static_cast<std::uint32_t>(3 * t);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}
Cube cube_of(const TriangleMesh& mesh) { return cube_around(bounds(mesh.positions)); }

/// Every voxel against every triangle.
std::vector<std::uint64_t> slow_codes(const TriangleMesh& mesh, unsigned depth,
                                      Separating separating) {
  const Cube cube = cube_of(mesh);
  std::vector<TriangleCells> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    triangles.emplace_back(grid_triangle(mesh, cube, t), kGridBits - depth, separating);
  std::vector<std::uint64_t> codes;
  for (std::uint64_t code = 0; code < std::uint64_t{1} << 3 * depth; ++code) {
    const Cell c = morton_decode(code);
    const GridPoint cell(c.x, c.y, c.z);
    for (const TriangleCells& t : triangles) {
      const bool in_bounds =
          max(cell, t.bounds().lower) == cell && min(cell, t.bounds().upper) == cell;
      if (in_bounds && t.covers(cell)) {
        codes.push_back(code);
        break;
      }
    }
  }
  return codes;
}

TEST(Voxelize, FindsTheVoxelsOfEveryVoxelTimesEveryTriangle) {
  for (const Separating separating : {Separating::k6, Separating::k26}) {
    for (const unsigned depth : {0U, 1U, 2U, 3U, 5U, 7U}) {
      const TriangleMesh mesh = random_mesh(20, depth > 5 ? 0.2F : 0.7F);
      const VoxelBlocks blocks =
          voxelize(mesh, cube_of(mesh), {.depth = depth, .separating = separating, .surface = {}});
      EXPECT_EQ(voxel_codes(blocks), slow_codes(mesh, depth, separating)) << depth;
    }
  }
}

TEST(Voxelize, FacesOnTheGridTouchBothSides) {
  TriangleMesh box;
  shapes::add_box(box, Vec3f(0), Vec3f(1), false);
  const Cube twice{Vec3d(-1), 2};  // the box is its upper octant
  const auto codes = voxel_codes(voxelize(box, twice, {.depth = 3, .surface = {}}));
  EXPECT_EQ(codes.size(), 5U * 5 * 5 - 2U * 2 * 2);
}

TEST(Voxelize, ThinVoxelsAreAmongTheConservativeOnes) {
  const TriangleMesh mesh = random_mesh(50, 0.5F);
  const auto thin = voxel_codes(
      voxelize(mesh, cube_of(mesh), {.depth = 6, .separating = Separating::k6, .surface = {}}));
  const auto all = voxel_codes(voxelize(mesh, cube_of(mesh), {.depth = 6, .surface = {}}));
  EXPECT_LT(thin.size(), all.size());
  EXPECT_TRUE(std::ranges::includes(all, thin));
}

TEST(Voxelize, DoesNotDependOnThreadsOrPasses) {
  const TriangleMesh mesh = random_mesh(3000, 0.05F);
  const auto build = [&](std::uint64_t list_bytes, std::uint64_t& passes) {
    VoxelizeConfig config{.depth = 9, .surface = {}, .list_bytes = list_bytes};
    config.surface = [&](std::uint32_t t, float u, float v) {
      return SurfaceSample{Rgb(u, v, static_cast<float>(t) / 3000), mesh.scaled_normal(t)};
    };
    VoxelBlocks all;
    passes = voxelize(mesh, cube_of(mesh), config, [&](VoxelBlocks&& blocks) {
               all.code.insert(all.code.end(), blocks.code.begin(), blocks.code.end());
               all.mask.insert(all.mask.end(), blocks.mask.begin(), blocks.mask.end());
               all.value.insert(all.value.end(), blocks.value.begin(), blocks.value.end());
             }).passes;
    return all;
  };
  std::uint64_t one = 0, many = 0;
  const VoxelBlocks whole = build(std::uint64_t{1} << 30, one);
  const VoxelBlocks cut = build(2000, many);
  const ThreadLimit limit(1);
  const VoxelBlocks alone = build(std::uint64_t{1} << 30, one);
  EXPECT_EQ(one, 1U);
  EXPECT_GT(many, 5U);
  EXPECT_EQ(whole.value.size(), whole.voxels());
  for (const VoxelBlocks* other : {&cut, &alone}) {
    EXPECT_TRUE(other->code == whole.code);
    EXPECT_TRUE(other->mask == whole.mask);
    EXPECT_TRUE(other->value == whole.value);
  }
}

TEST(Voxelize, ValuesAreMeansByArea) {
  // Two squares in one plane, of which the one is three times as large within the voxel.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0.5F}, {0.75F, 0, 0.5F}, {0.75F, 1, 0.5F},
                    {0, 1, 0.5F}, {1, 0, 0.5F},     {1, 1, 0.5F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  VoxelizeConfig config{.depth = 0, .surface = {}};
  config.surface = [](std::uint32_t t, float, float) {
    return SurfaceSample{t < 2 ? Rgb(1, 0, 0) : Rgb(0, 0, 1), Vec3f(0, 0, 2)};
  };
  const VoxelBlocks blocks = voxelize(mesh, {Vec3d(0), 1}, config);
  ASSERT_EQ(blocks.value.size(), 1U);
  const Rgb color = unpack_color(blocks.value[0].color);
  EXPECT_NEAR(color.x, 0.75F, 2e-3F);
  EXPECT_NEAR(color.z, 0.25F, 2e-3F);
  EXPECT_LT(length(unpack_normal(blocks.value[0].normal) - Vec3f(0, 0, 1)), 1e-4F);
}

TEST(Voxelize, TexturesAreSampledWhereTheVoxelIs) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0.3F}, {1, 0, 0.3F}, {0, 1, 0.3F}};
  mesh.triangles = {{0, 1, 2}};
  VoxelizeConfig config{.depth = 4, .surface = {}};
  config.surface = [](std::uint32_t, float u, float v) {
    return SurfaceSample{Rgb(u, v, 0), Vec3f(0, 0, 1)};
  };
  const VoxelBlocks blocks = voxelize(mesh, {Vec3d(0), 1}, config);
  const auto codes = voxel_codes(blocks);
  ASSERT_EQ(codes.size(), blocks.value.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const Cell cell = morton_decode(codes[i]);
    const Rgb color = unpack_color(blocks.value[i].color);
    EXPECT_NEAR(color.x * 16, static_cast<float>(cell.x) + 0.5F, 0.55F);
    EXPECT_NEAR(color.y * 16, static_cast<float>(cell.y) + 0.5F, 0.55F);
  }
}

TEST(Voxelize, EstimateIsNearForTrianglesLargerThanVoxels) {
  const TriangleMesh mesh = random_mesh(30, 0.8F);
  const Cube cube = cube_of(mesh);
  const auto voxels = voxelize(mesh, cube, {.depth = 8, .surface = {}}).voxels();
  const auto estimate = estimate_voxelize(mesh, cube, {.depth = 8, .surface = {}}).voxels;
  EXPECT_GT(estimate, voxels / 2);
  EXPECT_LT(estimate, 2 * voxels);
}

TEST(Voxelize, BadMeshesAreRefused) {
  const Cube cube{Vec3d(0), 1};
  TriangleMesh mesh = random_mesh(2, 0.5F);
  EXPECT_THROW(voxelize(mesh, cube, {.depth = 17, .surface = {}}), ValueError);
  mesh.positions[4].y = std::nanf("");
  EXPECT_THROW(voxelize(mesh, cube, {.depth = 3, .surface = {}}), ValueError);
  EXPECT_THROW(cube_around(bounds({})), ValueError);
  const Vec3f point[] = {{1, 2, 3}};
  EXPECT_THROW(cube_around(bounds(point)), ValueError);
  EXPECT_TRUE(voxelize(TriangleMesh{}, cube, {.depth = 3, .surface = {}}).code.empty());
}

TEST(Cube, IsCentredOnTheBoxAndAsWideAsItsLongestSide) {
  const Cube cube = cube_around({{0, 1, 2}, {4, 3, 2}});
  EXPECT_EQ(cube, (Cube{Vec3d(0, 0, 0), 4}));
  EXPECT_EQ(cube.snap({4, 2, 9}), GridPoint(1 << 26, 1 << 25, 1 << 26));
  EXPECT_EQ(cube.to_voxels({1, 2, 4}, 3), Vec3d(2, 4, 8));
}

}  // namespace
}  // namespace relumbre
