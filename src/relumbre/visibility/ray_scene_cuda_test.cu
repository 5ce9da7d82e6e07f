#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/visibility/bvh_tracer.h"
#include "relumbre/visibility/ray_scene_cuda.h"

namespace relumbre::cuda {
namespace {

std::vector<Ray> random_rays(std::size_t count) {
  RandomStream random(7);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = {random.uniform(), random.uniform(), random.uniform()};
    const float u = random.uniform();
    ray.direction = square_to_sphere(u, random.uniform()) * (0.1F + random.uniform());
    if (random.uniform() < 0.2F) ray.direction.z = 0;
    if (random.uniform() < 0.2F) ray.t_max = 0.3F;
  }
  return rays;
}

/// Lengths on both sides of where the device takes over, and of whole blocks.
TEST(RaySceneCuda, BatchesAgreeWithSingleRaysOnTheCpu) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = shapes::soup(700, 3);
  const RayScene scene = make_ray_scene(mesh, 0);
  const BvhTracer cpu(mesh);
  std::size_t hit = 0;
  for (const std::size_t count : {0U, 1U, 17U, 1023U, 1024U, 1025U, 2049U}) {
    const std::vector<Ray> rays = random_rays(count);
    std::vector<Hit> hits(count);
    std::vector<std::uint8_t> blocked(count);
    scene.closest(rays, hits);
    scene.occluded(rays, blocked);
    for (std::size_t i = 0; i < count; ++i) {
      const Hit expected = cpu.closest(rays[i]);
      EXPECT_EQ(hits[i].triangle, expected.triangle);
      EXPECT_EQ(hits[i].t, expected.t);
      EXPECT_EQ(hits[i].u, expected.u);
      EXPECT_EQ(hits[i].v, expected.v);
      EXPECT_EQ(hits[i].back, expected.back);
      EXPECT_EQ(blocked[i] != 0, static_cast<bool>(expected));
      hit += expected ? 1 : 0;
    }
  }
  EXPECT_GT(hit, 500U);
}

TEST(RaySceneCuda, ThreadsMayAskAtTheSameTime) {
  RELUMBRE_NEEDS_DEVICE();
  const RayScene scene = make_ray_scene(shapes::soup(200, 5), 0);
  const std::vector<Ray> rays = random_rays(1200);
  std::vector<Hit> alone(rays.size());
  scene.closest(rays, alone);
  std::vector<std::vector<Hit>> together(6, std::vector<Hit>(rays.size()));
  const ThreadLimit three(3);
  parallel_for(0, together.size(), 1, [&](std::size_t i) { scene.closest(rays, together[i]); });
  for (const std::vector<Hit>& hits : together) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      EXPECT_EQ(hits[i].triangle, alone[i].triangle);
      EXPECT_EQ(hits[i].t, alone[i].t);
    }
  }
}

TEST(RaySceneCuda, RaysThatGoNowhereHitNothing) {
  RELUMBRE_NEEDS_DEVICE();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const RayScene scene = make_ray_scene(shapes::soup(50, 1), 0);
  std::vector<Ray> rays(1100, Ray{{0.5F, 0.5F, 0.5F}, 0, {0, 0, 0}});
  rays[7].direction = {nan, 1, 0};
  rays[8] = {{nan, 0, 0}, 0, {1, 0, 0}};
  std::vector<Hit> hits(rays.size(), Hit{3, 1});
  scene.closest(rays, hits);
  for (const Hit& hit : hits) {
    EXPECT_FALSE(hit);
    EXPECT_EQ(hit.t, std::numeric_limits<float>::infinity());
  }
}

TEST(RaySceneCuda, SaysHowItWantsToBeAsked) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = shapes::soup(50, 1);
  const RayScene scene = make_ray_scene(mesh, 0);
  EXPECT_GE(scene.preferred_batch(), 1U << 16);
  EXPECT_EQ(scene.epsilon(), ray_epsilon(mesh));
  EXPECT_GT(scene.bytes(), 100 * sizeof(BvhTriangle));
}

TEST(RaySceneCuda, EmptyMeshIsNeverHit) {
  RELUMBRE_NEEDS_DEVICE();
  const RayScene scene = make_ray_scene(TriangleMesh{}, 0);
  std::vector<std::uint8_t> blocked(1500, 1);
  scene.occluded(random_rays(1500), blocked);
  for (const std::uint8_t b : blocked) EXPECT_EQ(b, 0);
}

TEST(RaySceneCuda, RefusesBatchesOfDifferentSizes) {
  RELUMBRE_NEEDS_DEVICE();
  const RayScene scene = make_ray_scene(shapes::soup(5, 1), 0);
  std::vector<Hit> hits(2);
  EXPECT_THROW(scene.closest(random_rays(3), hits), ShapeError);
}

}  // namespace
}  // namespace relumbre::cuda
