#include "relumbre/visibility/bvh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/visibility/bvh_tracer.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {
namespace {

/// Rays from within a box around the mesh, of directions of any length; some run along the axes.
std::vector<Ray> random_rays(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  const Box box = bounds(mesh.positions);
  RandomStream random(seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    const Vec3f at{random.uniform(), random.uniform(), random.uniform()};
    const float u = random.uniform();
    ray.origin = box.lower + (at * 1.2F - Vec3f(0.1F)) * box.size();
    ray.direction = square_to_sphere(u, random.uniform()) * (0.1F + random.uniform());
    if (random.uniform() < 0.1F) ray.direction.x = 0;
    if (random.uniform() < 0.1F) ray.direction.y = 0;
  }
  return rays;
}

std::vector<Hit> closest(const BvhTracer& tracer, std::span<const Ray> rays) {
  std::vector<Hit> hits(rays.size());
  tracer.closest(rays, hits);
  return hits;
}

/// Expects what Embree says, but for triangles at the same distance; returns how many rays hit.
std::size_t expect_same_as_embree(const TriangleMesh& mesh, std::span<const Ray> rays) {
  const RayScene embree(mesh);
  const BvhTracer ours(mesh);
  const float size = bounds(mesh.positions).diagonal();
  std::vector<Hit> expected(rays.size());
  embree.closest(rays, expected);
  const std::vector<Hit> found = closest(ours, rays);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit &a = expected[i], &b = found[i];
    EXPECT_EQ(ours.occluded(rays[i]), static_cast<bool>(b));
    EXPECT_EQ(static_cast<bool>(a), static_cast<bool>(b));
    if (!a || !b) continue;
    ++hits;
    EXPECT_NEAR(a.t, b.t, 1e-5F * a.t + 1e-6F * size / length(rays[i].direction));
    if (a.triangle != b.triangle) continue;
    EXPECT_NEAR(a.u, b.u, 2e-3F);
    EXPECT_NEAR(a.v, b.v, 2e-3F);
    EXPECT_EQ(a.back, b.back);
  }
  return hits;
}

/// What lies under a node, found by walking: triangles and levels.
struct Walk {
  std::vector<std::uint32_t> triangles;
  std::size_t depth = 0;
};

/// Expects that every triangle lies in all the boxes around it.
void walk(const Bvh& bvh, std::uint32_t index, std::size_t depth,
          const std::vector<std::array<Vec3d, 2>>& around, Walk& out) {
  const BvhNode& node = bvh.nodes[index];
  out.depth = std::max(out.depth, depth);
  std::uint32_t child = node.first_child;
  for (std::size_t s = 0; s < 8; ++s) {
    if (node.meta[s] == 0) continue;
    auto boxes = around;
    std::array<Vec3d, 2>& box = boxes.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double cell = std::ldexp(1.0, node.exponent[axis] - 127);
      const auto origin = static_cast<double>(node.origin[axis]);
      const double rounding = cell * 1e-12;  // the builder's, in double precision
      box[0][axis] = origin + node.lower[axis][s] * cell - rounding;
      box[1][axis] = origin + node.upper[axis][s] * cell + rounding;
    }
    if ((node.inner >> s & 1) != 0) {
      walk(bvh, child++, depth + 1, boxes, out);
      continue;
    }
    const auto count = static_cast<std::uint32_t>(std::popcount(std::uint32_t{node.meta[s]} >> 5));
    for (std::uint32_t i = 0; i < count; ++i) {
      const BvhTriangle& t = bvh.triangles[node.first_triangle + (node.meta[s] & 31U) + i];
      out.triangles.push_back(t.index);
      for (const auto& corner : {t.a, t.b, t.c}) {
        for (const auto& [lower, upper] : boxes) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            ASSERT_LE(lower[axis], static_cast<double>(corner[axis]));
            ASSERT_GE(upper[axis], static_cast<double>(corner[axis]));
          }
        }
      }
    }
  }
}

Walk walk(const Bvh& bvh) {
  Walk result;
  walk(bvh, 0, 1, {}, result);
  std::sort(result.triangles.begin(), result.triangles.end());
  EXPECT_EQ(result.depth, bvh.depth);
  EXPECT_LE(bvh.depth, Bvh::kMaxDepth);
  return result;
}

/// Expects every triangle once.
void expect_whole(const Bvh& bvh, std::size_t triangles) {
  const Walk found = walk(bvh);
  ASSERT_EQ(found.triangles.size(), triangles);
  for (std::size_t t = 0; t < triangles; ++t) ASSERT_EQ(found.triangles[t], t);
}

TEST(Bvh, BoxesHoldTheirTriangles) {
  for (const std::size_t triangles : {1U, 2U, 3U, 4U, 8U, 9U, 100U, 3001U}) {
    expect_whole(build_bvh(shapes::soup(triangles, triangles)), triangles);
  }
}

TEST(Bvh, FindsWhatEmbreeFinds) {
  const TriangleMesh soup = shapes::soup(5000, 1), room = shapes::blocks_in_room(),
                     sphere = shapes::sphere(64);
  EXPECT_GT(expect_same_as_embree(soup, random_rays(soup, 50000, 2)), 10000U);
  EXPECT_GT(expect_same_as_embree(room, random_rays(room, 50000, 3)), 30000U);
  EXPECT_GT(expect_same_as_embree(sphere, random_rays(sphere, 50000, 4)), 20000U);
}

TEST(Bvh, MovedAndScaledScenesAreHitLikeWhereTheyWere) {
  const TriangleMesh mesh = shapes::soup(500, 5);
  const std::vector<Ray> rays = random_rays(mesh, 5000, 6);
  const std::vector<Hit> expected = closest(BvhTracer(mesh), rays);
  for (const float scale : {0x1p-30F, 0x1p40F}) {  // powers of two: nothing is rounded
    TriangleMesh scaled = mesh;
    for (Vec3f& p : scaled.positions) p *= scale;
    std::vector<Ray> scaled_rays = rays;
    for (Ray& ray : scaled_rays) ray.origin *= scale, ray.direction *= scale;
    const std::vector<Hit> hits = closest(BvhTracer(scaled), scaled_rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(hits[i].triangle, expected[i].triangle);
      EXPECT_EQ(hits[i].t, expected[i].t);
    }
  }
}

/// From inside to points on edges and corners, which are shared by up to 2 · rings triangles.
TEST(Bvh, NothingLeaksThroughSharedEdgesAndCorners) {
  for (const Vec3f& center : {Vec3f{}, Vec3f{30, -200, 1000}}) {
    const TriangleMesh mesh = shapes::sphere(24, center, 1.5F);
    std::vector<Ray> rays;
    RandomStream random(8);
    for (std::size_t eye = 0; eye < 8; ++eye) {
      const float u = random.uniform();
      const Vec3f from = center + square_to_sphere(u, random.uniform()) * random.uniform();
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3f a = mesh.corner(t, eye % 3), b = mesh.corner(t, (eye + 1) % 3);
        for (const float s : {0.0F, 0.25F, 0.5F, random.uniform()}) {
          rays.push_back({from, 0, a + (b - a) * s - from});
        }
      }
    }
    for (const Hit& hit : closest(BvhTracer(mesh), rays)) EXPECT_TRUE(hit);
  }
}

TEST(Bvh, RaysAlongAnAxisMeetFlatBoxes) {
  TriangleMesh mesh;
  for (int i = 0; i < 40; ++i) {
    const auto z = static_cast<float>(i);
    shapes::add_quad(mesh, {0, 0, z}, {1, 0, 0}, {0, 1, 0});
  }
  const BvhTracer tracer(mesh);
  EXPECT_FLOAT_EQ(tracer.closest({{0.3F, 0.6F, 50}, 0, {0, 0, -1}}).t, 11);
  EXPECT_FLOAT_EQ(tracer.closest({{0.3F, 0.6F, 20.5F}, 0, {0, -0.0F, 2}}).t, 0.25F);
  EXPECT_FALSE(tracer.closest({{0.3F, 0.6F, 20.5F}, 0, {0, 1, 0}}));
  // On the border, and from very far away.
  EXPECT_TRUE(tracer.closest({{0, 0, 50}, 0, {0, 0, -1}}));
  EXPECT_TRUE(tracer.closest({{1, 0.5F, 50}, 0, {0, 0, -1}}));
  EXPECT_TRUE(tracer.closest({{0.3F, 0.6F, 5e6F}, 0, {0, 0, -1}}));
}

TEST(Bvh, OfEqualTrianglesTheFirstIsHit) {
  TriangleMesh mesh;
  for (int i = 0; i < 5000; ++i) shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const BvhTracer tracer(mesh);
  expect_whole(tracer.bvh(), 5000);
  EXPECT_EQ(tracer.closest({{0.2F, 0.2F, 1}, 0, {0, 0, -1}}).triangle, 0U);
  EXPECT_EQ(tracer.closest({{0.2F, 0.2F, -1}, 0, {0, 0, 1}}).triangle, 0U);
}

TEST(Bvh, IntervalIsOpenBelowAndClosedAbove) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const BvhTracer tracer(mesh);
  const auto hit = [&](float t_min, float t_max) {
    return static_cast<bool>(tracer.closest({{0.25F, 0.25F, 2}, t_min, {0, 0, -1}, t_max}));
  };
  EXPECT_TRUE(hit(1, 3));
  EXPECT_TRUE(hit(0, 2));
  EXPECT_FALSE(hit(2, 3));
  EXPECT_FALSE(hit(0, 1.999F));
}

/// Each triangle is half as large as the one before it: surface area splits off one at a time.
TEST(Bvh, DepthStaysBoundedOnNestedTriangles) {
  TriangleMesh mesh;
  for (int i = 0; i < 3000; ++i) {
    const float size = std::ldexp(1.0F, 50 - i % 150);
    shapes::add_triangle(mesh, {0, 0, 0}, {size, 0, 0}, {0, size, size});
  }
  const Bvh bvh = build_bvh(mesh);
  expect_whole(bvh, 3000);
}

TEST(Bvh, WhatIsNotATriangleIsNeverHit) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  TriangleMesh mesh = shapes::sphere(8);
  const std::size_t good = mesh.triangles.size();
  shapes::add_triangle(mesh, {nan, 0, 0}, {1, 0, 0}, {0, 1, 0});
  shapes::add_triangle(mesh, {0, 0, 0}, {infinity, 0, 0}, {0, 1, 0});
  shapes::add_triangle(mesh, {0, 0, 0}, {1e30F, 0, 0}, {0, 1, 0});
  for (int i = 0; i < 50; ++i) {
    shapes::add_triangle(mesh, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    shapes::add_triangle(mesh, {0, 0, 0}, {0.5F, 0.5F, 0.5F}, {0.1F, 0.1F, 0.1F});
  }
  const BvhTracer tracer(mesh);
  EXPECT_EQ(walk(tracer.bvh()).triangles.size(), good + 100);
  for (const Hit& hit : closest(tracer, random_rays(shapes::sphere(8), 2000, 9))) {
    EXPECT_TRUE(!hit || hit.triangle < good);
  }
  const BvhTracer empty{TriangleMesh{}};
  EXPECT_FALSE(empty.closest({{0, 0, 0}, 0, {0, 0, 1}}));
  TriangleMesh huge;
  shapes::add_triangle(huge, {-9e17F, -9e17F, 9e17F}, {9e17F, -9e17F, 9e17F}, {0, 9e17F, 9e17F});
  EXPECT_TRUE(BvhTracer(huge).closest({{0, 0, 0}, 0, {0, 0, 1}}));
}

TEST(Bvh, RaysThatGoNowhereHitNothing) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const BvhTracer tracer(shapes::sphere(8));
  EXPECT_TRUE(tracer.closest({{0, 0, 0}, 0, {0, 1e-20F, 0.1F}}));
  for (const Vec3f& d : {Vec3f{}, Vec3f{nan, 0, 1}, Vec3f{0, 0, infinity}, Vec3f{1e-42F, 0, 0}}) {
    EXPECT_FALSE(tracer.closest({{0, 0, 0}, 0, d}));
  }
  for (const Vec3f& o : {Vec3f{nan, 0, 0}, Vec3f{0, -infinity, 0}}) {
    EXPECT_FALSE(tracer.closest({o, 0, {0, 0, 1}}));
  }
}

TEST(Bvh, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = shapes::soup(40000, 10);
  const auto build = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return build_bvh(mesh);
  };
  const Bvh one = build(1), three = build(3);
  ASSERT_EQ(one.nodes.size(), three.nodes.size());
  const auto equal = [](const auto& a, const auto& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  EXPECT_TRUE(equal(one.nodes, three.nodes));
  EXPECT_TRUE(equal(one.triangles, three.triangles));
}

TEST(Bvh, PacketsAgreeWithSingleRays) {
  const TriangleMesh mesh = shapes::soup(300, 11);
  const BvhTracer tracer(mesh);
  const std::vector<Ray> rays = random_rays(mesh, RayPacket::kSize, 12);
  RayPacket packet{};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      packet.origin[axis][i] = rays[i].origin[axis];
      packet.direction[axis][i] = rays[i].direction[axis];
    }
    packet.t_min[i] = rays[i].t_min, packet.t_max[i] = rays[i].t_max;
  }
  HitPacket hits;
  tracer.closest(packet, hits, 11);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits.triangle[i], i < 11 ? tracer.closest(rays[i]).triangle : kNone);
  }
}

TEST(Bvh, RefusesAnIndexBeyondThePositions) {
  TriangleMesh mesh = shapes::soup(2, 1);
  mesh.triangles.push_back({0, 1, 6});
  EXPECT_THROW(build_bvh(mesh), ValueError);
}

}  // namespace
}  // namespace relumbre
