#include "relumbre/render/voxel_view.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/tree_cast.h"
#include "relumbre/octree/voxel_tree_builder.h"
#include "relumbre/octree/voxelize.h"
#include "relumbre/render/traversal_view.h"

namespace relumbre {
namespace {

/// A wall in the plane x + z = 1 of the unit cube, red on its left half and blue on its right.
VoxelTree wall(unsigned depth, bool with_values = true) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  VoxelizeConfig config{.depth = depth, .surface = {}};
  if (with_values) {
    config.surface = [&mesh](std::uint32_t t, float u, float v) {
      const Vec3f p =
          mesh.corner(t, 0) * (1 - u - v) + mesh.corner(t, 1) * u + mesh.corner(t, 2) * v;
      return SurfaceSample{p.x < 0.5F ? Rgb(1, 0, 0) : Rgb(0, 0, 1), mesh.scaled_normal(t)};
    };
  }
  const Cube cube{Vec3d(0), 1};
  return build_tree(cube, depth, Separating::k26, voxelize(mesh, cube, config));
}

Camera front() { return {.name = "", .eye = {0.5F, 0.5F, 3}, .target = {0.5F, 0.5F, 0}}; }

VoxelViewConfig small_view(VoxelShading shading) {
  return {.width = 64, .height = 48, .samples = 1, .shading = shading};
}

TEST(VoxelView, ShowsColoursWhereTheyAre) {
  const Image image = render_voxels(wall(6), front(), small_view(VoxelShading::kColor));
  const std::size_t row = 24 * 64;
  const Rgb left = image.rgb(row + 26), right = image.rgb(row + 38);
  EXPECT_GT(left.x, 0.95F);
  EXPECT_LT(left.z, 0.05F);
  EXPECT_GT(right.z, 0.95F);
  EXPECT_EQ(image.rgb(0), Rgb(0));
  EXPECT_EQ(image.channel("A")[0], 0);
  EXPECT_EQ(image.channel("A")[row + 26], 1);
}

TEST(VoxelView, DepthIsPlanarInMetresToAVoxel) {
  const Image image = render_voxels(wall(7), front(), small_view(VoxelShading::kColor));
  const auto z = image.channel("Z");
  EXPECT_EQ(z[0], std::numeric_limits<float>::infinity());
  const float tangent = std::tan(22.5F * std::numbers::pi_v<float> / 180) / 24;
  for (const std::size_t x : {27UL, 31UL, 36UL}) {
    // The ray (0.5 + s t, 0.5, 3 - t) meets x + z = 1 at t = 2.5 / (1 - s).
    const float s = (static_cast<float>(x) + 0.5F - 32) * tangent;
    EXPECT_NEAR(z[24 * 64 + x], 2.5F / (1 - s), 3.0F / 128) << x;
  }
}

TEST(VoxelView, NormalsFaceTheCamera) {
  const Image image = render_voxels(wall(6), front(), small_view(VoxelShading::kNormal));
  const std::size_t pixel = 24 * 64 + 30;
  EXPECT_NEAR(image.channel("N.X")[pixel], std::sqrt(0.5F), 0.02F);
  EXPECT_NEAR(image.channel("N.Z")[pixel], std::sqrt(0.5F), 0.02F);
  EXPECT_NEAR(image.rgb(pixel).x, (1 + std::sqrt(0.5F)) / 2, 0.02F);
}

TEST(VoxelView, WithoutValuesFacesAreShown) {
  const Image image = render_voxels(wall(6, false), front(), small_view(VoxelShading::kNormal));
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    if (image.channel("A")[i] == 0) continue;
    const float x = std::abs(image.channel("N.X")[i]), z = std::abs(image.channel("N.Z")[i]);
    EXPECT_EQ(x + z + std::abs(image.channel("N.Y")[i]), 1) << i;
  }
}

TEST(VoxelView, SmoothingInterpolatesAcrossTheEdgeOfAColour) {
  VoxelViewConfig config = small_view(VoxelShading::kColor);
  config.width = 640, config.height = 480;
  const Image sharp = render_voxels(wall(4), front(), config);
  config.smooth = true;
  const Image smooth = render_voxels(wall(4), front(), config);
  std::size_t sharp_steps = 0, smooth_steps = 0;
  float largest = 0;
  for (std::size_t x = 240; x < 400; ++x) {
    const std::size_t i = 240 * 640 + x;
    sharp_steps += std::abs(sharp.rgb(i).x - sharp.rgb(i + 1).x) > 0.01F;
    smooth_steps += std::abs(smooth.rgb(i).x - smooth.rgb(i + 1).x) > 0.01F;
    largest = std::max(largest, std::abs(smooth.rgb(i).x - smooth.rgb(i + 1).x));
  }
  EXPECT_LE(sharp_steps, 3U);
  EXPECT_GT(smooth_steps, 5U);
  EXPECT_LT(largest, 0.5F);
}

TEST(VoxelView, DoesNotDependOnTheNumberOfThreads) {
  VoxelViewConfig config = small_view(VoxelShading::kLit);
  config.samples = 5;
  const Image all = render_voxels(wall(5), front(), config);
  const ThreadLimit one(1);
  const Image alone = render_voxels(wall(5), front(), config);
  for (const auto& channel : all.channels())
    EXPECT_TRUE(std::ranges::equal(channel.values, alone.channel(channel.name))) << channel.name;
}

TEST(VoxelView, EachSideOfASheetHasItsOwnColour) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0.5F}, {1, 0, 0.5F}, {1, 1, 0.5F}, {0, 1, 0.5F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  VoxelizeConfig config{.depth = 7, .surface = {}};
  config.surface = [](std::uint32_t, float, float) {
    return SurfaceSample{Rgb(1, 0, 0), {0, 0, 1}, Rgb(0, 0, 1)};
  };
  const Cube cube{Vec3d(0), 1};
  const VoxelTree tree = build_tree(cube, 7, Separating::k26, voxelize(mesh, cube, config));
  Camera behind = front();
  behind.eye.z = -2;
  const std::size_t middle = 24 * 64 + 32;
  for (const double detail : {0.0, 1.0}) {
    VoxelViewConfig view = small_view(VoxelShading::kColor);
    view.detail = detail, view.smooth = detail > 0;
    EXPECT_EQ(render_voxels(tree, front(), view).rgb(middle), Rgb(1, 0, 0));
    EXPECT_EQ(render_voxels(tree, behind, view).rgb(middle), Rgb(0, 0, 1));
  }
}

TEST(VoxelView, EveryTraversalMakesTheSamePicture) {
  const VoxelTree tree = wall(6);
  VoxelViewConfig config = small_view(VoxelShading::kLit);
  const Image expected = render_voxels(tree, front(), config);
  using enum Traversal::Kind;
  for (const Traversal::Kind kind : {kRestart, kBacktrack, kFullStack, kShortStack}) {
    config.traversal = {kind, 2};
    const Image image = render_voxels(tree, front(), config);
    for (const auto& channel : expected.channels())
      EXPECT_TRUE(std::ranges::equal(channel.values, image.channel(channel.name))) << channel.name;
  }
  config.detail = 1;
  EXPECT_THROW((void)render_voxels(tree, front(), config), ValueError);
}

TEST(VoxelView, LevelOfDetailShowsMeansWithinAFewPixels) {
  const VoxelTree tree = wall(9);
  VoxelViewConfig config = small_view(VoxelShading::kColor);
  config.samples = 64;
  const Image exact = render_voxels(tree, front(), config);
  for (const bool smooth : {false, true}) {
    config.detail = 1, config.samples = 4, config.smooth = smooth;
    const Image image = render_voxels(tree, front(), config);
    double difference = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i)
      difference += static_cast<double>(std::abs(image.rgb(i).x - exact.rgb(i).x));
    EXPECT_LT(difference / static_cast<double>(image.pixels()), 0.02);
    EXPECT_NE(image.rgb(24 * 64 + 31), exact.rgb(24 * 64 + 31));
    // The wall is a thin diagonal sheet: nodes of up to a pixel (0.03 m wide) stand out before it.
    const auto z = image.channel("Z");
    for (const std::size_t x : {27UL, 31UL, 36UL})
      EXPECT_NEAR(z[24 * 64 + x], exact.channel("Z")[24 * 64 + x], 0.1F);
  }
  for (const double detail : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    config.detail = detail;
    EXPECT_THROW((void)render_voxels(tree, front(), config), ValueError);
  }
}

TEST(VoxelView, HeatMapsCountWhatTheTraversalDoes) {
  const VoxelTree tree = wall(5);
  const auto map = [&](Traversal::Kind kind) {
    return traversal_heat_map(tree, front(), 64, 48, {kind}, "reads");
  };
  const Image full = map(Traversal::Kind::kFullStack), restart = map(Traversal::Kind::kRestart);
  EXPECT_EQ(full.channel("level")[24 * 64 + 30], 5);
  EXPECT_EQ(full.channel("reads")[0], 0);
  double full_reads = 0, restart_reads = 0;
  for (std::size_t i = 0; i < full.pixels(); ++i) {
    full_reads += static_cast<double>(full.channel("reads")[i]);
    restart_reads += static_cast<double>(restart.channel("reads")[i]);
  }
  EXPECT_GT(full_reads, 0);
  EXPECT_GT(restart_reads, full_reads);
}

TEST(VoxelView, TheAutomaticCameraSeesAllOfTheCube) {
  TriangleMesh mesh;  // the cube's corners
  const Cube cube{Vec3d(-2, 5, 1), 3};
  for (unsigned c = 0; c < 8; ++c) {
    const auto at = [&](unsigned bit) { return static_cast<float>(c >> bit & 1) * 2.9F; };
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3f p = Vec3f(cube.corner) + Vec3f(at(0), at(1), at(2));
    for (const Vec3f& d : {Vec3f(0), Vec3f(0.1F, 0, 0), Vec3f(0, 0.1F, 0.1F)})
      mesh.positions.push_back(p + d);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const VoxelTree tree =
      build_tree(cube, 5, Separating::k26, voxelize(mesh, cube, {.depth = 5, .surface = {}}));
  VoxelViewConfig config = small_view(VoxelShading::kLit);
  config.width = 200, config.height = 150;
  const Image image = render_voxels(tree, voxel_camera(tree.cube()), config);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const std::size_t x = i % 200, y = i / 200;
    const bool is_edge = x == 0 || y == 0 || x == 199 || y == 149;
    EXPECT_TRUE(!is_edge || image.channel("A")[i] == 0) << x << ", " << y;
  }
}

TEST(VoxelView, BadSizesAndCamerasAreRefused) {
  VoxelViewConfig config = small_view(VoxelShading::kLit);
  config.samples = 0;
  EXPECT_THROW((void)render_voxels(wall(3), front(), config), ValueError);
  config.samples = 1, config.width = 0;
  EXPECT_THROW((void)render_voxels(wall(3), front(), config), ValueError);
  Camera camera = front();
  camera.target = camera.eye;
  EXPECT_THROW((void)render_voxels(wall(3), camera, small_view(VoxelShading::kLit)), ValueError);
}

}  // namespace
}  // namespace relumbre
