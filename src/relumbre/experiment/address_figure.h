/// Reads per node address: which words of an octree a picture asks for how often.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "relumbre/archsim/node_reads.h"
#include "relumbre/base/progress.h"
#include "relumbre/experiment/plan.h"
#include "relumbre/experiment/report_figures.h"

namespace relumbre {

/// The nodes of one scene that are read at all.
struct SceneReads {
  std::string scene;
  std::vector<NodeReads> nodes;
};

/// Of each scene, at its plan's depth nearest to 8, first resolution and first traversal. Casts a
/// picture a scene.
std::vector<SceneReads> count_scene_reads(const ExperimentPlan& plan, Progress& progress);

/// Reads over address, both logarithmic, a panel a scene: the mean and the largest of the nodes in
/// each of many ranges of addresses. A level's addresses are 8 times its parents'.
NamedFigure figure_by_address(std::span<const SceneReads> scenes);

}  // namespace relumbre
