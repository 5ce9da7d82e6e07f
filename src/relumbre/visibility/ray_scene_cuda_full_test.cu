// The device's hits against Embree's.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/visibility/ray_scene_cuda.h"

namespace relumbre::cuda {
namespace {

TEST(RaySceneCuda, FindsWhatEmbreeFinds) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = shapes::soup(3000, 4);
  const RayScene embree(mesh), ours = make_ray_scene(mesh, 0);
  RandomStream random(2);
  std::vector<Ray> rays(20000);
  for (Ray& ray : rays) {
    ray.origin = {random.uniform(), random.uniform(), random.uniform()};
    const float u = random.uniform();
    ray.direction = square_to_sphere(u, random.uniform());
  }
  std::vector<Hit> expected(rays.size()), found(rays.size());
  std::vector<std::uint8_t> blocked(rays.size());
  embree.closest(rays, expected);
  ours.closest(rays, found);
  ours.occluded(rays, blocked);
  std::size_t hits = 0, others = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits += expected[i] ? 1 : 0;
    others += expected[i].triangle == found[i].triangle ? 0 : 1;
    EXPECT_EQ(blocked[i] != 0, static_cast<bool>(found[i]));
    if (!expected[i] || expected[i].triangle != found[i].triangle) continue;
    EXPECT_NEAR(expected[i].t, found[i].t, 1e-5F * expected[i].t + 5e-6F);
    EXPECT_EQ(expected[i].back, found[i].back);
  }
  EXPECT_GT(hits, 5000U);
  EXPECT_LE(others, 1U);
}

}  // namespace
}  // namespace relumbre::cuda
