#include "relumbre/experiment/planned_scene.h"

#include "relumbre/base/error.h"
#include "relumbre/render/voxel_view.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/import.h"

namespace relumbre {

Scene planned_scene(const PlannedScene& scene) {
  if (!scene.builtin.empty()) return make_builtin_scene(scene.builtin);
  return import_scene(scene.mesh).scene;
}

WordScene planned_words(const ExperimentPlan& plan, const Scene& scene, const std::string& name,
                        std::uint32_t depth, Progress& progress) {
  const auto separating = plan.separating == 6 ? Separating::k6 : Separating::k26;
  try {
    return word_scene(scene.mesh, depth, separating, progress);
  } catch (const ValueError& error) {
    throw ValueError("scene \"" + name + "\": " + error.what());
  }
}

Camera planned_camera(const ExperimentPlan& plan, const Cube& cube) {
  return plan.camera_file.empty() ? voxel_camera(cube) : read_camera(plan.camera_file);
}

}  // namespace relumbre
