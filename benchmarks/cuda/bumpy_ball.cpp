#include "bumpy_ball.h"

#include <cmath>
#include <numbers>

#include "relumbre/octree/voxel_tree_builder.h"
#include "relumbre/octree/voxelize.h"

namespace relumbre::bench {

namespace {

constexpr std::size_t kAcross = 1600, kDown = 800;

Vec3f point(std::size_t i, std::size_t j) {
  const double u = 2 * std::numbers::pi * static_cast<double>(i) / kAcross;
  const double v = std::numbers::pi * static_cast<double>(j) / kDown;
  double radius = 1;
  for (double f = 5, height = 0.12; f < 200; f *= 2.3, height *= 0.45)
    radius += height * std::sin(f * u + 3 * std::cos(f * v)) * std::sin(f * v) * std::sin(v);
  return Vec3f(radius * Vec3d(std::sin(v) * std::cos(u), std::cos(v), std::sin(v) * std::sin(u)));
}

TriangleMesh ball() {
  TriangleMesh mesh;
  for (std::size_t j = 0; j <= kDown; ++j)
    for (std::size_t i = 0; i < kAcross; ++i) mesh.positions.push_back(point(i, j));
  const auto vertex = [](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(j * kAcross + i % kAcross);
  };
  for (std::size_t j = 0; j < kDown; ++j) {
    for (std::size_t i = 0; i < kAcross; ++i) {
      mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j)});
      mesh.triangles.push_back({vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
    }
  }
  return mesh;
}

}  // namespace

VoxelTree bumpy_ball(unsigned depth) {
  const TriangleMesh mesh = ball();
  const Cube cube = cube_around(bounds(mesh.positions));
  VoxelTreeBuilder builder(cube, depth, Separating::k26);
  voxelize(mesh, cube, {.depth = depth}, [&](VoxelBlocks&& blocks) { builder.add(blocks); });
  return builder.finish();
}

}  // namespace relumbre::bench
