#include "relumbre/experiment/run_experiment.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "relumbre/archsim/simulate.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/experiment/cells_csv.h"
#include "relumbre/experiment/machine_trace.h"
#include "relumbre/experiment/plan_hash.h"
#include "relumbre/experiment/planned_scene.h"

namespace relumbre {

namespace {

namespace fs = std::filesystem;

/// The folder of the results.
class ResultsFolder {
 public:
  ResultsFolder(std::uint64_t hash, fs::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) throw FileError(folder_.string(), "cannot be made: " + error.message());
    claim(fmt::format("{:016x}", hash));
  }

  /// Finished cells, which begin the plan's.
  [[nodiscard]] std::vector<ExperimentCell> cells() const {
    return fs::exists(csv()) ? read_cells_csv(csv()) : std::vector<ExperimentCell>{};
  }
  void save(std::span<const ExperimentCell> cells) const { write_file(csv(), cells_to_csv(cells)); }
  [[nodiscard]] std::string csv() const { return (folder_ / "cells.csv").string(); }

 private:
  void claim(const std::string& hash) const {
    const fs::path label = folder_ / "experiment.json";
    if (!fs::exists(label)) {
      if (fs::exists(csv()))
        throw FileError(csv(), "belongs to no plan: experiment.json is missing");
      write_file(label, nlohmann::json{{"plan", hash}}.dump(2) + "\n");
      return;
    }
    const auto json = nlohmann::json::parse(read_file(label), nullptr, false);
    if (!json.is_object() || !json.contains("plan") || !json["plan"].is_string())
      throw FileError(label.string(), "is damaged");
    if (json["plan"] != hash)
      throw FileError(folder_.string(),
                      "holds the results of another plan, of other meshes or of another version: "
                      "choose another folder");
  }

  fs::path folder_;
};

/// What a cell is before anything is counted.
ExperimentCell labelled(const ExperimentPlan& plan, std::size_t index) {
  const PlannedCell at = cell_at(plan, index);
  return {.scene = plan.scenes[at.scene].name,
          .traversal = to_string(plan.traversals[at.traversal]),
          .depth = plan.depths[at.depth],
          .width = plan.resolutions[at.resolution].width,
          .height = plan.resolutions[at.resolution].height,
          .gts = plan.gts[at.gts],
          .tile = plan.tiles[at.tile],
          .lines = plan.lines[at.lines]};
}

bool is_same_cell(ExperimentCell counted, const ExperimentCell& label) {
  counted.tasks = 0, counted.levels.clear();
  return counted == label;
}

ExperimentCell counted(ExperimentCell label, const UnitCounters& total) {
  label.tasks = total.tasks;
  for (const CacheCounters& c : total.levels)
    label.levels.push_back({c.reads, c.hits, c.replacements, c.lines_used});
  return label;
}

/// Whether all lines come out of one pass.
bool in_one_pass(const ExperimentPlan& plan) {
  return plan.ways == 1 && std::ranges::all_of(plan.lines, std::has_single_bit<std::uint64_t>);
}

std::vector<Simulation> simulate_all_lines(const ExperimentPlan& plan, const Trace& trace,
                                           MachineConfig machine, const Progress& progress) {
  progress.check();
  if (in_one_pass(plan)) return simulate_lines(trace, machine, plan.lines);
  std::vector<Simulation> all;
  for (const std::uint64_t lines : plan.lines) {
    progress.check();
    machine.lines = lines;
    all.push_back(simulate(trace, machine));
  }
  return all;
}

/// All cells of one picture; the first is number `first` of the plan. Throws Cancelled.
std::vector<ExperimentCell> simulate_picture(const ExperimentPlan& plan, std::size_t first,
                                             const Trace& trace, const Progress& progress) {
  const std::size_t lines = plan.lines.size(), machines = plan.gts.size() * plan.tiles.size();
  std::vector<ExperimentCell> cells(machines * lines);
  parallel_for(0, machines, 1, [&](std::size_t m) {
    const ExperimentCell label = labelled(plan, first + m * lines);
    const MachineConfig machine{
        .gts = label.gts, .tile = label.tile, .ways = plan.ways, .replacement = plan.replacement};
    const std::vector<Simulation> all = simulate_all_lines(plan, trace, machine, progress);
    for (std::size_t l = 0; l < lines; ++l)
      cells[m * lines + l] = counted(labelled(plan, first + m * lines + l), all[l].total);
  });
  return cells;
}

class ExperimentRunner {
 public:
  ExperimentRunner(const ExperimentPlan& plan, const fs::path& folder, Progress& progress)
      : plan_(plan),
        hash_(plan_hash(plan)),
        folder_(hash_, folder),
        progress_(progress),
        quiet_(progress),
        picture_(plan.gts.size() * plan.tiles.size() * plan.lines.size()) {}

  ExperimentRun run() {
    take_what_is_there();
    ExperimentRun result{.hash = hash_, .cells = {}, .found_before = cells_.size()};
    progress_.begin("simulate", pixels_left());
    while (cells_.size() < cell_count(plan_)) {
      add_picture();
      folder_.save(cells_);
      progress_.advance(pixels(cells_.size() - picture_));
    }
    result.cells = std::move(cells_);
    return result;
  }

 private:
  /// Whole pictures: one whose cells are not all there is cast again.
  void take_what_is_there() {
    cells_ = folder_.cells();
    cells_.resize(std::min(cells_.size() / picture_ * picture_, cell_count(plan_)));
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (!is_same_cell(cells_[i], labelled(plan_, i)))
        throw FileError(folder_.csv(), fmt::format("is damaged: cell {} is not the plan's", i));
  }

  [[nodiscard]] std::uint64_t pixels(std::size_t cell) const {
    const Resolution& r = plan_.resolutions[cell_at(plan_, cell).resolution];
    return std::uint64_t{r.width} * r.height;
  }
  [[nodiscard]] std::uint64_t pixels_left() const {
    std::uint64_t sum = 0;
    for (std::size_t c = cells_.size(); c < cell_count(plan_); c += picture_) sum += pixels(c);
    return sum;
  }

  void add_picture() {
    const std::size_t first = cells_.size();
    const PlannedCell at = cell_at(plan_, first);
    const WordScene& words = words_of(at);
    const Resolution& resolution = plan_.resolutions[at.resolution];
    const Trace trace = machine_trace(
        words.octree, words.cube, planned_camera(plan_, words.cube),
        {resolution.width, resolution.height, plan_.traversals[at.traversal]}, quiet_);
    std::vector<ExperimentCell> cells = simulate_picture(plan_, first, trace, progress_);
    progress_.check();
    std::ranges::move(cells, std::back_inserter(cells_));
  }

  /// Scenes and octrees are kept until the next one is asked for.
  const WordScene& words_of(const PlannedCell& at) {
    if (scene_number_ != at.scene) {
      scene_ = planned_scene(plan_.scenes[at.scene]);
      scene_number_ = at.scene;
      words_.reset();
    }
    if (!words_ || words_depth_ != at.depth) {
      words_.reset();
      words_.emplace(planned_words(plan_, scene_, plan_.scenes[at.scene].name,
                                   plan_.depths[at.depth], quiet_));
      words_depth_ = at.depth;
    }
    return *words_;
  }

  const ExperimentPlan& plan_;
  std::uint64_t hash_;
  ResultsFolder folder_;
  Progress& progress_;
  QuietProgress quiet_;
  std::size_t picture_;  ///< cells of one
  std::vector<ExperimentCell> cells_;
  std::optional<std::size_t> scene_number_;
  Scene scene_;
  std::optional<WordScene> words_;
  std::size_t words_depth_ = 0;
};

}  // namespace

ExperimentRun run_experiment(const ExperimentPlan& plan, const fs::path& folder,
                             Progress& progress) {
  return ExperimentRunner(plan, folder, progress).run();
}

}  // namespace relumbre
