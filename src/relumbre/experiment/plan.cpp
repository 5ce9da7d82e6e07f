#include "relumbre/experiment/plan.h"

#include <cassert>

#include <fmt/format.h>

namespace relumbre {

namespace {

template <class T, class Name>
std::string line_of(const char* key, const std::vector<T>& levels, Name name) {
  std::string line = key;
  line += ':';
  for (const T& level : levels) line += " " + name(level);
  return line + "\n";
}

/// Length first, so that no name can look like two.
std::string scene_text(const PlannedScene& scene) {
  const std::string source =
      scene.builtin.empty() ? scene.mesh.filename().string() : "builtin:" + scene.builtin;
  return fmt::format("{}:{} {}:{}", scene.name.size(), scene.name, source.size(), source);
}

}  // namespace

std::string to_string(const Resolution& resolution) {
  return fmt::format("{}x{}", resolution.width, resolution.height);
}

std::string to_string(const PlannedTraversal& traversal) {
  if (!traversal) return "gt";
  switch (traversal->kind) {
    case Traversal::Kind::kRestart:
      return "restart";
    case Traversal::Kind::kBacktrack:
      return "backtrack";
    case Traversal::Kind::kFullStack:
      return "full-stack";
    case Traversal::Kind::kShortStack:
      break;
  }
  return fmt::format("short-stack({})", traversal->stack_nodes);
}

std::string to_string(Replacement replacement) {
  switch (replacement) {
    case Replacement::kLru:
      return "lru";
    case Replacement::kFifo:
      return "fifo";
    case Replacement::kRandom:
      break;
  }
  return "random";
}

std::size_t cell_count(const ExperimentPlan& plan) {
  return plan.scenes.size() * plan.depths.size() * plan.resolutions.size() *
         plan.traversals.size() * plan.gts.size() * plan.tiles.size() * plan.lines.size();
}

PlannedCell cell_at(const ExperimentPlan& plan, std::size_t index) {
  assert(index < cell_count(plan));
  const auto next = [&index](std::size_t levels) {
    const std::size_t level = index % levels;
    index /= levels;
    return level;
  };
  PlannedCell cell;
  cell.lines = next(plan.lines.size());
  cell.tile = next(plan.tiles.size());
  cell.gts = next(plan.gts.size());
  cell.traversal = next(plan.traversals.size());
  cell.resolution = next(plan.resolutions.size());
  cell.depth = next(plan.depths.size());
  cell.scene = next(plan.scenes.size());
  return cell;
}

std::string canonical_text(const ExperimentPlan& plan) {
  const auto number = [](auto value) { return std::to_string(value); };
  const auto named = [](const auto& value) { return to_string(value); };
  return "relumbre experiment 1\n" + line_of("scenes", plan.scenes, scene_text) +
         line_of("depth", plan.depths, number) + line_of("resolution", plan.resolutions, named) +
         line_of("traversal", plan.traversals, named) + line_of("gts", plan.gts, number) +
         line_of("tile", plan.tiles, number) + line_of("lines", plan.lines, number) +
         fmt::format("separating: {}\ncamera: {}\nways: {}\nreplacement: {}\n", plan.separating,
                     plan.camera_file.empty() ? "auto" : "a file", plan.ways,
                     to_string(plan.replacement));
}

}  // namespace relumbre
