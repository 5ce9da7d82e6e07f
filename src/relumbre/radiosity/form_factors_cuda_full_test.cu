// The device's counts against those of Highway's rays through Embree.
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/testing.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/radiosity/count_differences.h"
#include "relumbre/radiosity/form_factor_rows.h"
#include "relumbre/radiosity/form_factors_cuda.h"

namespace relumbre::cuda {
namespace {

std::uint64_t differences(const TriangleMesh& mesh, std::size_t k, std::size_t n,
                          std::uint32_t rays) {
  TessellationConfig cut;
  cut.patches = k, cut.elements = n;
  const Tessellation tessellation = tessellate(mesh, cut);
  FormFactorConfig config;
  config.rays = rays;
  const RayScene embree(mesh);
  const FormFactors expected =
      relumbre::trace_form_factors(tessellation, embree, config, Binning::kPatches);
  SparseCounts found;
  found.columns = expected.counts.columns, found.rays = rays;
  trace_form_factors(
      mesh, tessellation, config, Binning::kPatches, 0,
      [&](std::size_t, const SparseCounts& block, const RayTally&) { append(found, block); });
  EXPECT_EQ(found.rows(), expected.counts.rows());
  return rays_counted_otherwise(found, expected.counts);
}

/// Of a million rays about one passes so close to an edge that rounding decides.
TEST(FormFactorsCuda, AgreeWithEmbreeButForRaysAtEdges) {
  RELUMBRE_NEEDS_DEVICE();
  TriangleMesh room;  // as blocks_in_room(), but nothing lies in the plane of something else
  shapes::add_box(room, {0, 0, 0}, {5.5F, 5.5F, 5.6F}, true);
  shapes::add_box(room, {0.8F, 0.2F, 0.7F}, {2.4F, 1.65F, 2.3F}, false);
  shapes::add_box(room, {3.1F, 0.01F, 2.5F}, {4.7F, 3.3F, 4.1F}, false);
  EXPECT_LE(differences(room, 40, 331, 512), 3U);
  TriangleMesh sphere = shapes::sphere(20);
  for (Index3& t : sphere.triangles) std::swap(t[1], t[2]);
  EXPECT_LE(differences(sphere, 100, 700, 128), 3U);
}

}  // namespace
}  // namespace relumbre::cuda
