/// Rays for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "relumbre/base/vec3.h"

namespace relumbre::test {

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

inline std::vector<TestRay> test_rays(int depth, std::size_t count) {
  TestRays stream(depth, count);
  std::vector<TestRay> rays(count);
  for (TestRay& ray : rays) ray = stream.next();
  return rays;
}

}  // namespace relumbre::test
