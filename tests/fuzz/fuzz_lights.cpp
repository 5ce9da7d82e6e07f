// Feeds arbitrary text to the lights.json and cam.json readers: they must return or throw an Error.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "relumbre/base/error.h"
#include "relumbre/scene/camera.h"
#include "relumbre/scene/lights_json.h"
#include "relumbre/scene/scene.h"

namespace {

relumbre::Scene scene_with_an_emitter() {
  relumbre::Scene scene;
  relumbre::Light light;
  light.name = "lamp";
  light.type = relumbre::LightType::kEmitter;
  scene.lights.push_back(light);
  return scene;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const relumbre::Scene scene = scene_with_an_emitter();
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    // A folder that does not exist: the files that lights name must not be found.
    const auto lights = relumbre::parse_lights(text, "fuzz.json", "/nonexistent/folder", scene);
    (void)relumbre::combine_lights(scene.lights, lights, true);
  } catch (const relumbre::Error&) {
  }
  try {
    (void)relumbre::parse_camera(text, "fuzz.json");
  } catch (const relumbre::Error&) {
  }
  return 0;
}
