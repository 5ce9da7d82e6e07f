#include <algorithm>
#include <filesystem>

#include "cli/command.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/experiment/address_figure.h"
#include "relumbre/experiment/report.h"
#include "relumbre/experiment/run_experiment.h"
#include "relumbre/plot/svg.h"

namespace relumbre::cli {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::string plan, folder;
};

template <class T, class Name>
std::string joined(const std::vector<T>& values, const Name& name) {
  std::string text;
  for (const T& value : values) text += (text.empty() ? "" : ", ") + name(value);
  return text;
}

std::vector<std::pair<std::string, std::string>> facts(const ExperimentPlan& plan,
                                                       const std::string& file,
                                                       std::uint64_t hash) {
  const auto source = [](const PlannedScene& scene) {
    return scene.name + " (" +
           (scene.builtin.empty() ? scene.mesh.filename().string() : "built in") + ")";
  };
  return {{"Plan", fs::path(file).filename().string()},
          {"Hash of the plan and its meshes", fmt::format("{:016x}", hash)},
          {"Program", std::string("relumbre ") + RELUMBRE_VERSION},
          {"Scenes", joined(plan.scenes, source)},
          {"Voxels", plan.separating == 6 ? "thin (6-separating)" : "conservative (26-separating)"},
          {"Camera", plan.camera_file.empty() ? "automatic: all of the cube, from three quarters "
                                                "above"
                                              : plan.camera_file.filename().string()},
          {"Geometry units", joined(plan.gts, [](std::uint32_t g) { return std::to_string(g); })},
          {"Traversal", joined(plan.traversals,
                               [](const PlannedTraversal& t) {
                                 return t ? to_string(t) : std::string("the machine's own");
                               })},
          {"Caches", plan.ways == 1 ? "direct-mapped"
                     : plan.ways == 0
                         ? "fully associative, " + to_string(plan.replacement)
                         : fmt::format("{} ways, {}", plan.ways, to_string(plan.replacement))}};
}

void write_report(const ExperimentPlan& plan, const Options& options, const ExperimentRun& run,
                  Session& session) {
  const fs::path folder = options.folder;
  const ExperimentReport report =
      make_report({.title = plan.title,
                   .facts = facts(plan, options.plan, run.hash),
                   .cells = run.cells,
                   .more_figures = {figure_by_address(count_scene_reads(plan, session.progress))}},
                  session.progress);
  session.progress.clear();
  fs::create_directories(folder / "figures");
  for (const NamedFigure& named : report.figures)
    write_file(folder / "figures" / (named.name + ".svg"), to_svg(named.figure));
  write_file(folder / "report.html", report.html);
  session.report.figure("cells_csv", "cells", (folder / "cells.csv").string());
  session.report.figure(
      "figures", "figures", report.figures.size(),
      fmt::format("{} in {}", report.figures.size(), (folder / "figures").string()));
  session.report.figure("report", "report", (folder / "report.html").string());
}

void run(const Options& options, Session& session) {
  const ExperimentPlan plan = read_plan(options.plan);
  session.report.figure("planned", "cells planned", cell_count(plan), grouped(cell_count(plan)));
  const Stopwatch watch;
  const ExperimentRun run = run_experiment(plan, options.folder, session.progress);
  session.progress.clear();
  if (run.found_before > 0)
    session.report.figure("found", "found in the folder", run.found_before,
                          grouped(run.found_before));
  session.report.figure("run_s", "run in", watch.seconds(), seconds_text(watch.seconds()));
  std::uint64_t reads = 0;
  for (const ExperimentCell& cell : run.cells) reads += cell_reads(cell);
  session.report.figure("reads", "reads simulated", reads, grouped(reads));
  write_report(plan, options, run, session);
}

}  // namespace

void add_experiment_command(CLI::App& app) {
  add_command<Options>(
      app, "experiment", "Simulate every combination of a plan's factors, and report on them",
      "relumbre experiment plan.toml -o results",
      [](CLI::App& command, Options& o) {
        command.add_option("plan", o.plan, "What to run (.toml)")->required();
        command
            .add_option("-o,--output", o.folder,
                        "Folder for results; one with results of the same plan is gone on with")
            ->required();
      },
      run);
}

}  // namespace relumbre::cli
