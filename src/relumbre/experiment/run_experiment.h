/// Runs a plan: every cell's picture is cast once and replayed on every machine.
///
///   for each scene, depth          an octree of words
///     each resolution, traversal   one trace of the picture's reads
///       each gts, tile             one pass for all lines, where caches are direct-mapped
///
/// The results of a folder:
///
///   experiment.json   the plan's hash (plan_hash.h)
///   cells.csv         cells that are finished, in the plan's order
///
/// cells.csv is written anew, atomically, after each picture, so that a run that was stopped or
/// killed goes on there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/experiment/cell.h"
#include "relumbre/experiment/plan.h"

namespace relumbre {

struct ExperimentRun {
  std::uint64_t hash = 0;             ///< plan_hash of the plan
  std::vector<ExperimentCell> cells;  ///< all of the plan's, in its order
  std::size_t found_before = 0;       ///< cells that the folder had already
};

/// Makes the folder if need be. Progress counts pixels. Throws FileError for a folder that holds
/// results of another plan, or damaged ones, and for meshes and files; ValueError for a mesh that
/// cannot be voxelised, a camera or a machine that cannot be; Cancelled, with all finished pictures
/// kept.
ExperimentRun run_experiment(const ExperimentPlan& plan, const std::filesystem::path& folder,
                             Progress& progress = no_progress());

}  // namespace relumbre
