/// The scenes and cameras of a plan.
#pragma once

#include "relumbre/base/progress.h"
#include "relumbre/experiment/plan.h"
#include "relumbre/experiment/word_scene.h"
#include "relumbre/scene/camera.h"
#include "relumbre/scene/scene.h"

namespace relumbre {

/// Throws FileError.
Scene planned_scene(const PlannedScene& scene);

/// Throws ValueError that names the scene.
WordScene planned_words(const ExperimentPlan& plan, const Scene& scene, const std::string& name,
                        std::uint32_t depth, Progress& progress);

/// Automatic: sees all of the cube. Throws FileError.
Camera planned_camera(const ExperimentPlan& plan, const Cube& cube);

}  // namespace relumbre
