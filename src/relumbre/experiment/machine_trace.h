/// What the simulated machine is fed with: the reads of a picture's primary rays.
#pragma once

#include <cstdint>
#include <optional>

#include "relumbre/archsim/trace.h"
#include "relumbre/base/progress.h"
#include "relumbre/octree/cube.h"
#include "relumbre/octree/traverse.h"
#include "relumbre/scene/camera.h"

namespace relumbre {

struct MachineTraceConfig {
  std::uint32_t width = 640, height = 480;
  /// None: the machine's own, geometry_unit.h. With one of the survey's, a task is a node whose box
  /// the traversal compares with the ray.
  std::optional<Traversal> traversal = {};
};

/// One ray through each pixel's centre. `cube` is what the octree divides, in metres; the camera's
/// rays are CameraRays'. Threaded by rows; the same trace for any number of threads. Throws
/// ValueError for a camera, a size or a traversal that cannot be, Cancelled.
Trace machine_trace(const Octree& octree, const Cube& cube, const Camera& camera,
                    const MachineTraceConfig& config, Progress& progress = no_progress());

}  // namespace relumbre
