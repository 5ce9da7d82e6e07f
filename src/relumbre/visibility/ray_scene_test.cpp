#include "relumbre/visibility/ray_scene.h"

#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

/// A triangle in z = 0 that faces +z.
TriangleMesh one_triangle() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// The cube [-1, 1]³ with its faces to the inside, each side cut into cells × cells × 2 triangles.
TriangleMesh inward_cube(std::uint32_t cells) {
  TriangleMesh mesh;
  const auto grid = [&](Vec3f corner, Vec3f u, Vec3f v) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t j = 0; j <= cells; ++j) {
      for (std::uint32_t i = 0; i <= cells; ++i) {
        const float s = static_cast<float>(i) / static_cast<float>(cells);
        const float t = static_cast<float>(j) / static_cast<float>(cells);
        mesh.positions.push_back(corner + u * s + v * t);
      }
    }
    for (std::uint32_t j = 0; j < cells; ++j) {
      for (std::uint32_t i = 0; i < cells; ++i) {
        const std::uint32_t a = base + j * (cells + 1) + i, b = a + 1, d = a + cells + 1;
        mesh.triangles.push_back({a, d + 1, b});
        mesh.triangles.push_back({a, d, d + 1});
      }
    }
  };
  grid({-1, -1, -1}, {0, 0, 2}, {0, 2, 0});
  grid({1, -1, -1}, {0, 2, 0}, {0, 0, 2});
  grid({-1, -1, -1}, {2, 0, 0}, {0, 0, 2});
  grid({-1, 1, -1}, {0, 0, 2}, {2, 0, 0});
  grid({-1, -1, -1}, {0, 2, 0}, {2, 0, 0});
  grid({-1, -1, 1}, {2, 0, 0}, {0, 2, 0});
  return mesh;
}

std::vector<Ray> random_rays(std::size_t count) {
  RandomStream random(7);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = {random.uniform() - 0.5F, random.uniform() - 0.5F, random.uniform() - 0.5F};
    const float u = random.uniform();
    ray.direction = square_to_sphere(u, random.uniform()) * (0.1F + random.uniform());
  }
  return rays;
}

TEST(RayScene, CounterClockwiseSideIsTheFront) {
  const RayScene scene(one_triangle());
  const Hit from_above = scene.closest({{0.25F, 0.5F, 2}, 0, {0, 0, -1}});
  ASSERT_TRUE(from_above);
  EXPECT_FALSE(from_above.back);
  EXPECT_FLOAT_EQ(from_above.t, 2);
  const Hit from_below = scene.closest({{0.25F, 0.5F, -2}, 0, {0, 0, 2}});
  ASSERT_TRUE(from_below);
  EXPECT_TRUE(from_below.back);
  EXPECT_FLOAT_EQ(from_below.t, 1);
}

TEST(RayScene, BarycentricsAreWeightsOfCornersOneAndTwo) {
  const RayScene scene(one_triangle());
  const Hit hit = scene.closest({{0.25F, 0.5F, 2}, 0, {0, 0, -1}});
  EXPECT_EQ(hit.triangle, 0U);
  EXPECT_FLOAT_EQ(hit.u, 0.25F);
  EXPECT_FLOAT_EQ(hit.v, 0.5F);
}

TEST(RayScene, IntervalBoundsTheSearch) {
  const RayScene scene(one_triangle());
  const Ray through{{0.25F, 0.25F, 2}, 0, {0, 0, -1}};
  Ray starts_behind = through, ends_before = through;
  starts_behind.t_min = 2.5F;
  ends_before.t_max = 1.5F;
  EXPECT_TRUE(scene.occluded(through));
  EXPECT_FALSE(scene.closest(starts_behind));
  EXPECT_FALSE(scene.occluded(starts_behind));
  EXPECT_FALSE(scene.closest(ends_before));
  EXPECT_FALSE(scene.occluded(ends_before));
}

TEST(RayScene, BatchesAgreeWithSingleRaysAtEveryLength) {
  const RayScene scene(inward_cube(7));
  for (const std::size_t count : {0, 1, 15, 16, 17, 31, 257}) {
    const std::vector<Ray> rays = random_rays(count);
    std::vector<Hit> hits(count);
    scene.closest(rays, hits);
    for (std::size_t i = 0; i < count; ++i) {
      const Hit single = scene.closest(rays[i]);
      ASSERT_EQ(hits[i].triangle, single.triangle);
      EXPECT_NEAR(hits[i].t, single.t, 1e-5F * single.t);
      EXPECT_NEAR(hits[i].u, single.u, 1e-4F);
      EXPECT_NEAR(hits[i].v, single.v, 1e-4F);
      EXPECT_FALSE(hits[i].back);
    }
  }
}

TEST(RayScene, OcclusionAgreesWithClosestHit) {
  const RayScene scene(one_triangle());
  std::vector<Ray> rays = random_rays(501);
  for (Ray& ray : rays) ray.t_max = 1;
  std::vector<std::uint8_t> blocked(rays.size());
  scene.occluded(rays, blocked);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool expected{scene.closest(rays[i])};
    EXPECT_EQ(blocked[i] != 0, expected);
    EXPECT_EQ(scene.occluded(rays[i]), expected);
    hits += expected ? 1 : 0;
  }
  EXPECT_GT(hits, 10U);
  EXPECT_LT(hits, 490U);
}

TEST(RayScene, NothingLeaksThroughSharedEdgesAndVertices) {
  const std::uint32_t cells = 9;
  const TriangleMesh mesh = inward_cube(cells);
  const RayScene scene(mesh);
  std::vector<Ray> rays;
  const Vec3f eye{0.1234F, -0.0567F, 0.0891F};
  for (const Index3& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f a = mesh.positions[t[c]], b = mesh.positions[t[(c + 1) % 3]];
      for (int s = 0; s < 8; ++s) {
        rays.push_back({eye, 0, a + (b - a) * (static_cast<float>(s) / 8) - eye});
      }
    }
  }
  std::vector<Hit> hits(rays.size());
  scene.closest(rays, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(hits[i]);
    EXPECT_TRUE(scene.closest(rays[i]));
  }
}

TEST(RayScene, InactiveLanesMiss) {
  const RayScene scene(inward_cube(1));
  RayPacket rays{};
  rays.direction[2].fill(1);
  rays.t_max.fill(10);
  HitPacket hits;
  scene.closest(rays, hits, 5);
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) EXPECT_EQ(hits.triangle[i] != kNone, i < 5);
}

TEST(RayScene, EmptyMeshIsNeverHit) {
  const RayScene scene(TriangleMesh{});
  const std::vector<Ray> rays = random_rays(20);
  std::vector<Hit> hits(rays.size());
  scene.closest(rays, hits);
  for (const Hit& hit : hits) EXPECT_FALSE(hit);
  EXPECT_FALSE(scene.closest(rays[0]));
  EXPECT_FALSE(scene.occluded(rays[0]));
  EXPECT_EQ(scene.epsilon(), 0);
}

TEST(RayScene, EpsilonFollowsTheLargestCoordinate) {
  TriangleMesh mesh = one_triangle();
  mesh.positions[0] = {0, -20, 0};
  EXPECT_FLOAT_EQ(RayScene(mesh).epsilon(), 2e-4F);
}

TEST(RayScene, LargerMeshesHoldMoreBytes) {
  const std::size_t small = RayScene(inward_cube(10)).bytes();
  const std::size_t large = RayScene(inward_cube(40)).bytes();
  EXPECT_GT(small, 1200 * sizeof(Index3));
  EXPECT_GT(large, 4 * small);
}

TEST(RayScene, RefusesAnIndexBeyondThePositions) {
  TriangleMesh mesh = one_triangle();
  mesh.triangles.push_back({0, 1, 3});
  EXPECT_THROW(RayScene{mesh}, ValueError);
}

TEST(RayScene, RefusesBatchesOfDifferentSizes) {
  const RayScene scene(one_triangle());
  const std::vector<Ray> rays = random_rays(3);
  std::vector<Hit> hits(2);
  std::vector<std::uint8_t> blocked(4);
  EXPECT_THROW(scene.closest(rays, hits), ShapeError);
  EXPECT_THROW(scene.occluded(rays, blocked), ShapeError);
}

}  // namespace
}  // namespace relumbre
