/// Voxel sets and rays for the tests of this module.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/octree/morton.h"

namespace relumbre::octree_testing {

/// Sorted Morton codes.
using VoxelSet = std::vector<std::uint64_t>;

/// About `count` of a grid of 2^depth cells per edge.
inline VoxelSet random_voxels(int depth, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  VoxelSet voxels(count);
  for (std::uint64_t& code : voxels) code = random() >> (64 - 3 * depth);
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

inline VoxelSet all_voxels(int depth) {
  VoxelSet voxels(std::size_t{1} << 3 * depth);
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = i;
  return voxels;
}

/// Cells that the sphere about the cube's centre, of 0.45 of its edge, passes through: those with
/// corners within and outside.
inline VoxelSet shell(int depth) {
  const auto edge = static_cast<std::int64_t>(1) << depth;
  const double radius2 = 0.81 * static_cast<double>(edge * edge);
  VoxelSet voxels;
  // In halves of a cell about the centre: a cell reaches from 2·i - edge to 2·i - edge + 2.
  const auto nearer = [&](std::int64_t i) {
    return std::min(std::abs(2 * i - edge), std::abs(2 * i + 2 - edge));
  };
  const auto farther = [&](std::int64_t i) {
    return std::max(std::abs(2 * i - edge), std::abs(2 * i + 2 - edge));
  };
  for (std::int64_t z = 0; z < edge; ++z)
    for (std::int64_t y = 0; y < edge; ++y)
      for (std::int64_t x = 0; x < edge; ++x) {
        const std::int64_t a = nearer(x), b = nearer(y), c = nearer(z);
        const std::int64_t p = farther(x), q = farther(y), r = farther(z);
        if (static_cast<double>(a * a + b * b + c * c) <= radius2 &&
            radius2 < static_cast<double>(p * p + q * q + r * r))
          voxels.push_back(
              morton_encode(Cell{static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                 static_cast<std::uint32_t>(z)}));
      }
  std::sort(voxels.begin(), voxels.end());
  return voxels;
}

struct TestRay {
  Vec3d origin, direction;
};

/// Rays of every sort that a traversal could go wrong on, in a grid of this depth: each component
/// of the origin is random, an integer, a half or a bound of the cube, within it or not; each
/// component of the direction random, a small integer (diagonals, edges, corners), zero, negative
/// zero or all but zero. Half of them aim at the cube.
class TestRays {
 public:
  TestRays(int depth, std::uint64_t seed) : edge_(std::ldexp(1.0, depth)), random_(seed) {}

  TestRay next() {
    TestRay ray;
    for (std::size_t axis = 0; axis < 3; ++axis) ray.origin[axis] = coordinate();
    const std::uint64_t sort = pick(4);
    if (sort == 0) {  // at a point of the cube, often a corner of cells
      const Vec3d target(inside(), inside(), inside());
      ray.direction = target - ray.origin;
    } else {
      for (std::size_t axis = 0; axis < 3; ++axis)
        ray.direction[axis] = sort == 1 ? uniform(-1, 1) : slope();
    }
    return ray;
  }

 private:
  std::uint64_t pick(std::uint64_t choices) { return random_() % choices; }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double inside() { return pick(2) == 0 ? uniform(0, edge_) : std::floor(uniform(0, edge_ + 1)); }
  double coordinate() {
    switch (pick(6)) {
      case 0:
        return uniform(-edge_, 2 * edge_);
      case 1:
        return uniform(0, edge_);
      case 2:
        return std::floor(uniform(-edge_, 2 * edge_));
      case 3:
        return std::floor(uniform(0, edge_)) + 0.5;
      case 4:
        return pick(2) == 0 ? 0.0 : edge_;
      default:
        return std::floor(uniform(0, edge_ + 1));
    }
  }
  double slope() {
    switch (pick(8)) {
      case 0:
        return 0.0;
      case 1:
        return -0.0;
      case 2:
        return pick(2) == 0 ? 5e-324 : -5e-324;  // parallel: 1/d overflows
      case 3:
        return pick(2) == 0 ? 1e-307 : -1e-307;  // not parallel, t overflows
      case 4:
        return uniform(-1, 1);
      default:
        return static_cast<double>(pick(5)) - 2;  // -2 to 2
    }
  }

  double edge_;
  std::mt19937_64 random_;
};

}  // namespace relumbre::octree_testing
