/// What results of an experiment belong together.
#pragma once

#include <cstdint>

#include "relumbre/experiment/plan.h"

namespace relumbre {

/// Goes up whenever the same plan and the same geometry would give other counts: when the
/// voxelisers, the automatic camera, the traversals or the caches come to count differently.
inline constexpr std::uint32_t kMachineRevision = 1;

/// A hash of kMachineRevision, of canonical_text, of the camera's file and of every scene's
/// triangles as they are imported, in whatever files they are: results of one hash belong together.
/// Imports each scene once. Throws FileError where a file cannot be read or imported.
std::uint64_t plan_hash(const ExperimentPlan& plan);

}  // namespace relumbre
