/// Lit scenes for the tests of views.
#pragma once

#include "relumbre/render/test_support.h"
#include "relumbre/render/view.h"

namespace relumbre::test {

/// A scene with light in it that needs no operator: whatever a test puts into `lit`.
struct Lit {
  Cut cut;
  DisplayMesh display;
  std::vector<Rgb> reflectance;
  std::vector<Light> lights;
  RelitResult lit;

  Lit(Scene scene, std::size_t patches, std::size_t elements)
      : cut(std::move(scene), patches, elements),
        display(conforming_mesh(cut.tessellation)),
        reflectance(cut.reflectances()) {
    lit.emission.assign(elements, Rgb{});
    lit.direct_irradiance.assign(elements, Rgb{});
    lit.radiosity.assign(elements, Rgb{});
  }
  [[nodiscard]] Image render(const Camera& camera, const ViewConfig& config) const {
    return render_view({cut.scene, cut.tessellation, display, cut.rays, reflectance, lights, lit},
                       camera, config);
  }
};

/// Looks along −z from z = 2 at the origin.
inline Camera ahead() {
  Camera camera;
  camera.eye = {0, 0, 2};
  return camera;
}

/// A room with walls of radiosity e / (1 − ρ) everywhere.
inline Lit furnace() {
  Scene scene;
  const std::uint32_t m = add_material(scene, Rgb(0.5F), Rgb(1.0F));
  add_room(scene, m, {-1, -1, -1}, {1, 1, 1});
  for (std::uint32_t& object : scene.mesh.object) object = 0;
  Lit lit(std::move(scene), 12, 100);
  lit.lights = {emitter_light(0)};
  lit.lit.emission.assign(100, Rgb(1.0F));
  lit.lit.direct_irradiance.assign(100, Rgb(1.0F));
  lit.lit.radiosity.assign(100, Rgb(2.0F));
  return lit;
}

}  // namespace relumbre::test
