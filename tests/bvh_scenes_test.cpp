// Our own ray tracer, which a GPU shares, against Embree on whole scenes.
#include <cstdlib>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "packed_scene.h"
#include "relumbre/base/sampling.h"
#include "relumbre/radiosity/count_differences.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/visibility/bvh_tracer.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {
namespace {

FormFactors factors_by(const RayScene& rays, const Tessellation& tessellation) {
  return trace_form_factors(tessellation, rays, {.rays = 512}, Binning::kPatches);
}

FormFactors ours(const Scene& scene, const Tessellation& tessellation) {
  return factors_by(RayScene(std::make_unique<BvhTracer>(scene.mesh), ray_epsilon(scene.mesh)),
                    tessellation);
}

/// Of 512 rays from each element, how many the two tracers count differently.
std::uint64_t differences(const Scene& scene, std::size_t patches, std::size_t elements) {
  const Tessellation tessellation =
      tessellate(scene.mesh, {.patches = patches, .elements = elements, .separate = {}});
  const FormFactors embree = factors_by(RayScene(scene.mesh), tessellation);
  return rays_counted_otherwise(embree.counts, ours(scene, tessellation).counts);
}

/// Measured with Embree 3.13.5: 5 of 7,077,888; 6 of 8,192,000; 0 of 3,145,728; 2 of 8,192,000.
TEST(BvhScenes, CountsAgreeWithEmbreesButForRaysAtEdges) {
  EXPECT_LE(differences(make_cornell_scene(), 864, 13824), 12U);
  EXPECT_LE(differences(make_room_scene(), 1000, 16000), 12U);
  EXPECT_EQ(differences(make_furnace_cube_scene(), 96, 6144), 0U);
  EXPECT_LE(differences(make_teapots_scene(), 1000, 16000), 12U);
}

TEST(BvhScenes, ClosedScenesLeakNothing) {
  const Scene scene = make_furnace_cube_scene();
  const Tessellation tessellation =
      tessellate(scene.mesh, {.patches = 96, .elements = 6144, .separate = {}});
  const RayTally tally = ours(scene, tessellation).tally;
  EXPECT_EQ(tally.escaped, 0U);
  EXPECT_EQ(tally.back_face, 0U);
}

/// From all around to points on triangles of the scanned bunny.
TEST(BvhScenes, HitsAreEmbreesOnAScan) {
  const auto bunny = bench::read_packed_scene("stanford/bun_zipper.ply");
  if (!bunny) GTEST_SKIP() << "RELUMBRE_DATA has no stanford/bun_zipper.ply.xz";
  const TriangleMesh& mesh = bunny->mesh;
  const RayScene embree(mesh);
  const BvhTracer own(mesh);
  const Box box = bounds(mesh.positions);
  RandomStream random(1);
  std::size_t others = 0;
  for (std::size_t i = 0; i < 200000; ++i) {
    const float u = random.uniform();
    const Vec3f from = box.center() + square_to_sphere(u, random.uniform()) * box.diagonal();
    const std::size_t t = i * 7919 % mesh.triangles.size();
    const float v = 0.1F + 0.4F * random.uniform(), w = 0.1F + 0.4F * random.uniform();
    const Vec3f to =
        mesh.corner(t, 0) * (1 - v - w) + mesh.corner(t, 1) * v + mesh.corner(t, 2) * w;
    const Ray ray{from, 0, to - from};
    const Hit a = embree.closest(ray), b = own.closest(ray);
    ASSERT_TRUE(a && b);
    if (a.triangle == b.triangle) {
      EXPECT_NEAR(a.t, b.t, 1e-3F);  // triangles seen nearly edge-on
    } else {
      ++others;
    }
  }
  EXPECT_LE(others, 20U);  // 6 were measured: at edges, where Embree takes what lies 1e-5 outside
}

}  // namespace
}  // namespace relumbre
