#include "relumbre/experiment/address_figure.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "relumbre/experiment/machine_trace.h"
#include "relumbre/experiment/planned_scene.h"

namespace relumbre {

namespace {

constexpr std::uint32_t kDepth = 8;
constexpr double kRangesPerOctave = 8;  // of addresses

std::uint32_t depth_nearest(const std::vector<std::uint32_t>& depths, std::uint32_t wanted) {
  return *std::ranges::min_element(depths, {}, [&](std::uint32_t depth) {
    return std::abs(static_cast<int>(depth) - static_cast<int>(wanted));
  });
}

/// Reads of the nodes in one range of addresses.
struct Range {
  double sum = 0, most = 0, nodes = 0, addresses = 0;
  void add(const NodeReads& node) {
    const auto reads = static_cast<double>(node.reads);
    sum += reads, most = std::max(most, reads), nodes += 1;
    addresses += static_cast<double>(node.address);
  }
};

Panel panel_of(const SceneReads& scene) {
  std::map<int, Range> ranges;
  for (const NodeReads& node : scene.nodes) {
    const double octave = std::log2(static_cast<double>(node.address));
    ranges[static_cast<int>(octave * kRangesPerOctave)].add(node);
  }
  Panel panel{.title = scene.scene,
              .x = {.label = "node address", .scale = Scale::kLog10},
              .y = {.label = "reads", .scale = Scale::kLog10}};
  Series mean{.name = "mean of the nodes around", .line = false};
  Series most{.name = "most of them", .line = false};
  for (const auto& [key, range] : ranges) {
    const double address = range.addresses / range.nodes;
    mean.points.push_back({address, range.sum / range.nodes});
    most.points.push_back({address, range.most});
  }
  panel.series = {std::move(mean), std::move(most)};
  return panel;
}

}  // namespace

std::vector<SceneReads> count_scene_reads(const ExperimentPlan& plan, Progress& progress) {
  std::vector<SceneReads> all;
  const Resolution& resolution = plan.resolutions.front();
  progress.begin("reads per node", plan.scenes.size());
  QuietProgress quiet(progress);
  for (const PlannedScene& planned : plan.scenes) {
    const Scene scene = planned_scene(planned);
    const WordScene words =
        planned_words(plan, scene, planned.name, depth_nearest(plan.depths, kDepth), quiet);
    const Trace trace =
        machine_trace(words.octree, words.cube, planned_camera(plan, words.cube),
                      {resolution.width, resolution.height, plan.traversals.front()}, quiet);
    all.push_back({planned.name, count_node_reads(trace)});
    progress.advance(1);
  }
  return all;
}

NamedFigure figure_by_address(std::span<const SceneReads> scenes) {
  NamedFigure named{.name = "reads-by-address", .figure = {}};
  named.figure.title = "Reads per node address";
  named.figure.columns = 2;
  named.figure.share_x = named.figure.share_y = true;
  for (const SceneReads& scene : scenes)
    if (!scene.nodes.empty()) named.figure.panels.push_back(panel_of(scene));
  return named;
}

}  // namespace relumbre
