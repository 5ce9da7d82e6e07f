// Bakes the Cornell box in memory, lights it with a lamp of your own, and prints how bright each
// object is by direct light alone and after the light has settled.

#include <cstdio>
#include <exception>
#include <vector>

#include "relumbre/geometry/tessellation.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/render/direct_light.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/element_materials.h"
#include "relumbre/visibility/ray_scene.h"

using namespace relumbre;

namespace {

/// Area-weighted mean luminance of each object's elements.
std::vector<double> mean_by_object(const Scene& scene, const Tessellation& elements,
                                   const std::vector<Rgb>& light) {
  std::vector<double> power(scene.objects.size()), area(scene.objects.size());
  for (std::size_t i = 0; i < elements.elements(); ++i) {
    const std::uint32_t object = scene.mesh.object[elements.facets_of(i)[0].triangle];
    power[object] += static_cast<double>(elements.area[i] * luminance(light[i]));
    area[object] += static_cast<double>(elements.area[i]);
  }
  for (std::size_t o = 0; o < power.size(); ++o) power[o] /= area[o];
  return power;
}

void relight() {
  // Once: cut the scene, shoot rays, invert the k × k system.
  const Scene scene = make_builtin_scene("cornell");
  const Tessellation elements =
      tessellate(scene.mesh, {.patches = 216, .elements = 3456, .method = PatchMethod::kHierarchy});
  const ElementMaterials materials = element_materials(scene, elements);
  const RayScene rays(scene.mesh);
  const FormFactors form_factors =
      trace_form_factors(elements, rays, {.rays = 256}, Binning::kPatches);
  const auto relight_operator = make_compressed_operator(
      {form_factors.counts, elements.patch_offsets, elements.area, materials.reflectance},
      CountFormat::kCounts8);

  // As often as you like: a lamp, its directly reflected light, and what settles.
  const Light lamp{.name = "lamp", .position = {0.28F, 0.4F, 0.2F}, .intensity = 2};
  const std::vector<Rgb> irradiance = light_response(scene, elements, rays, lamp, {});
  std::vector<Rgb> light(irradiance.size());
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] = materials.reflectance[i] * irradiance[i] * lamp.power();
  }
  const std::vector<double> direct = mean_by_object(scene, elements, light);
  const std::span<float> flat(&light[0].x, light.size() * 3);
  relight_operator->apply(flat, flat);
  const std::vector<double> settled = mean_by_object(scene, elements, light);

  std::printf("%-12s %14s %14s\n", "object", "direct W/m2", "settled W/m2");
  for (std::size_t o = 0; o < direct.size(); ++o) {
    std::printf("%-12s %14.3f %14.3f\n", scene.objects[o].name.c_str(), direct[o], settled[o]);
  }
}

}  // namespace

int main() {
  try {
    relight();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
