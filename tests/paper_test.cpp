// The figures that the paper and the theory promise, on the whole pipeline.

#include <cmath>

#include <gtest/gtest.h>

#include "relumbre/radiosity/form_factors.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/radiosity/seen_area.h"
#include "relumbre/radiosity/solver.h"
#include "relumbre/render/direct_light.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/element_materials.h"
#include "relumbre/store/bake.h"

namespace relumbre {
namespace {

struct Pipeline {
  Scene scene;
  Tessellation elements;
  RayScene rays;
  std::vector<Rgb> reflectance;

  Pipeline(std::string_view name, TessellationConfig config)
      : scene(make_builtin_scene(name)),
        elements(cut(config)),
        rays(scene.mesh),
        reflectance(element_materials(scene, elements).reflectance) {}

  Tessellation cut(TessellationConfig config) const {
    const std::vector<std::uint32_t> labels = emissive_labels(scene);
    if (config.method == PatchMethod::kCluster) config.separate = labels;
    return tessellate(scene.mesh, config);
  }
  std::unique_ptr<RelightOperator> compressed(const SparseCounts& counts) const {
    return make_compressed_operator(
        {counts, elements.patch_offsets, seen_area(counts, elements.area), reflectance},
        CountFormat::kCounts8);
  }
};

std::span<float> flat(std::vector<Rgb>& values) { return {&values[0].x, values.size() * 3}; }

/// √Σ area |a − b|² / √Σ area |b|².
double relative_l2(const std::vector<float>& area, const std::vector<Rgb>& a,
                   const std::vector<Rgb>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3d d = Vec3d(a[i]) - Vec3d(b[i]);
    difference += static_cast<double>(area[i]) * dot(d, d);
    size += static_cast<double>(area[i]) * dot(Vec3d(b[i]), Vec3d(b[i]));
  }
  return std::sqrt(difference / size);
}

TEST(Paper, ItsNineCasesComeOutExactly) {
  const Scene scene = make_builtin_scene("cornell");
  EXPECT_EQ(scene.mesh.triangles.size(), 36U);
  const std::size_t cases[][2] = {{3456, 216},   {3456, 864},  {13824, 216},
                                  {3456, 3456},  {13824, 864}, {55296, 216},
                                  {13824, 3456}, {55296, 864}, {221184, 216}};
  for (const auto& [n, k] : cases) {
    const Tessellation cut =
        tessellate(scene.mesh, {.patches = k, .elements = n, .method = PatchMethod::kHierarchy});
    EXPECT_EQ(cut.elements(), n);
    EXPECT_EQ(cut.patches(), k);
  }
}

TEST(Furnace, RadiosityIsEmissionOverOneMinusRhoAtEveryElement) {
  Pipeline cube("furnace-cube",
                {.patches = 48, .elements = 3072, .method = PatchMethod::kHierarchy});
  const FormFactorConfig config = {.rays = 256};
  const SparseCounts u =
      trace_form_factors(cube.elements, cube.rays, config, Binning::kPatches).counts;
  const SparseCounts f =
      trace_form_factors(cube.elements, cube.rays, config, Binning::kElements).counts;
  for (const float rho : {0.5F, 0.9F}) {
    cube.reflectance.assign(cube.elements.elements(), Rgb(rho));
    std::vector<Rgb> emission(cube.elements.elements(), Rgb(1.0F)), b(emission.size());
    cube.compressed(u)->apply(flat(emission), flat(b));
    const std::vector<Rgb> exact = solve_radiosity(f, cube.reflectance, emission).radiosity;
    for (std::size_t i = 0; i < b.size(); ++i) {
      EXPECT_NEAR(b[i].x * (1 - rho), 1, 1e-4) << "compressed, element " << i;
      EXPECT_NEAR(exact[i].x * (1 - rho), 1, 1e-4) << "solve, element " << i;
    }
  }
}

class CompressedAgainstSolve : public testing::Test {
 protected:
  /// Relative L2 error of all reflected light under `light`.
  static double error(const Light& light) {
    Pipeline cornell("cornell",
                     {.patches = 864, .elements = 13824, .method = PatchMethod::kHierarchy});
    std::vector<Rgb> e = light_response(cornell.scene, cornell.elements, cornell.rays, light, {});
    for (std::size_t i = 0; i < e.size(); ++i) e[i] *= cornell.reflectance[i];
    const FormFactorConfig config = {.rays = 512};
    const SparseCounts u =
        trace_form_factors(cornell.elements, cornell.rays, config, Binning::kPatches).counts;
    const SparseCounts f =
        trace_form_factors(cornell.elements, cornell.rays, config, Binning::kElements).counts;
    const std::vector<Rgb> exact = solve_radiosity(f, cornell.reflectance, e).radiosity;
    std::vector<Rgb> b(e.size());
    cornell.compressed(u)->apply(flat(e), flat(b));
    return relative_l2(cornell.elements.area, b, exact);
  }
};

TEST_F(CompressedAgainstSolve, CeilingLampWithinOnePercent) {
  EXPECT_LE(error(make_builtin_scene("cornell").lights.at(0)), 0.01);
}

TEST_F(CompressedAgainstSolve, LampOfOneElementsSizeWithinThreePercent) {
  // An element of n = 13,824 covers about 1.2 cm².
  const Light small = {.name = "small",
                       .type = LightType::kQuad,
                       .position = {0.27F, 0.5475F, 0.27F},
                       .edge1 = {0.011F, 0, 0},
                       .edge2 = {0, 0, 0.011F}};
  EXPECT_LE(error(small), 0.03);
}

}  // namespace
}  // namespace relumbre
