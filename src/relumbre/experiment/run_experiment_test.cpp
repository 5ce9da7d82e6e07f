#include "relumbre/experiment/run_experiment.h"

#include <atomic>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "relumbre/archsim/simulate.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/experiment/address_figure.h"
#include "relumbre/experiment/cells_csv.h"
#include "relumbre/experiment/machine_trace.h"
#include "relumbre/experiment/plan_hash.h"
#include "relumbre/experiment/planned_scene.h"

namespace relumbre {
namespace {

ExperimentPlan small_plan(const std::string& more = "") {
  return parse_plan(R"([factors]
scenes = ["builtin:teapots", "builtin:cornell"]
depth = [3, 5]
tile = [3, 20]
lines = [64, 512]
resolution = ["33x21", "40x30"]
)" + more,
                    "plan.toml", ".");
}

/// Cancels after so many pictures.
class StopAfter : public Progress {
 public:
  explicit StopAfter(int pictures) : left_(pictures) {}
  void advance(std::uint64_t) override { --left_; }
  [[nodiscard]] bool cancelled() const override { return left_ <= 0; }

 private:
  std::atomic<int> left_;
};

void expect_refused(const ExperimentPlan& plan, const std::filesystem::path& folder,
                    const std::string& reason) {
  try {
    (void)run_experiment(plan, folder);
    ADD_FAILURE() << "ran: " << reason;
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

TEST(RunExperiment, EveryCellIsWhatItsMachineCountsAlone) {
  for (const char* more : {"[machine]\ngts = [1, 3]\ntraversal = [\"gt\", \"restart\"]\n",
                           "[machine]\nways = 2\nreplacement = \"fifo\"\n"}) {
    const ExperimentPlan plan = small_plan(more);
    const TemporaryFolder folder;
    const ExperimentRun run = run_experiment(plan, folder / "results");
    ASSERT_EQ(run.cells.size(), cell_count(plan));
    EXPECT_EQ(run.found_before, 0U);
    EXPECT_EQ(run.hash, plan_hash(plan));
    for (std::size_t i = 0; i < run.cells.size(); i += 5) {
      const ExperimentCell& cell = run.cells[i];
      const PlannedCell at = cell_at(plan, i);
      const Scene scene = planned_scene(plan.scenes[at.scene]);
      const WordScene words = planned_words(plan, scene, cell.scene, cell.depth, no_progress());
      const Trace trace = machine_trace(words.octree, words.cube, planned_camera(plan, words.cube),
                                        {cell.width, cell.height, plan.traversals[at.traversal]});
      const UnitCounters expected = simulate(trace, {.gts = cell.gts,
                                                     .tile = cell.tile,
                                                     .lines = cell.lines,
                                                     .ways = plan.ways,
                                                     .replacement = plan.replacement})
                                        .total;
      EXPECT_EQ(cell.tasks, expected.tasks);
      ASSERT_EQ(cell.levels.size(), expected.levels.size());
      for (std::size_t l = 0; l < cell.levels.size(); ++l) {
        EXPECT_EQ(cell.levels[l].reads, expected.levels[l].reads);
        EXPECT_EQ(cell.levels[l].hits, expected.levels[l].hits);
        EXPECT_EQ(cell.levels[l].replacements, expected.levels[l].replacements);
        EXPECT_EQ(cell.levels[l].lines_used, expected.levels[l].lines_used);
      }
    }
  }
}

TEST(RunExperiment, GoesOnWhereItWasStopped) {
  const ExperimentPlan plan = small_plan();
  const TemporaryFolder folder;
  const ExperimentRun whole = run_experiment(plan, folder / "whole");
  for (const int pictures : {1, 3, 7}) {
    const auto results = folder / std::to_string(pictures);
    StopAfter stop(pictures);
    EXPECT_THROW((void)run_experiment(plan, results, stop), Cancelled);
    const ThreadLimit one(1);
    const ExperimentRun rest = run_experiment(plan, results);
    EXPECT_EQ(rest.found_before, static_cast<std::size_t>(pictures) * 4);
    EXPECT_EQ(rest.cells, whole.cells);
    EXPECT_EQ(read_file(results / "cells.csv"), read_file(folder / "whole/cells.csv"));
  }
  EXPECT_EQ(run_experiment(plan, folder / "whole").found_before, cell_count(plan));
}

TEST(RunExperiment, HearsThatItShouldStopBetweenMachines) {
  // Asked once more a machine and cache size: as many questions more as there are machines more.
  class Questions : public Progress {
   public:
    [[nodiscard]] bool cancelled() const override { return ++asked, false; }
    mutable std::atomic<int> asked = 0;
  };
  const auto questions = [](const std::string& more) {
    const TemporaryFolder folder;
    Questions progress;
    (void)run_experiment(small_plan(more), folder / "r", progress);
    return progress.asked.load();
  };
  constexpr int kPictures = 8, kTiles = 2, kLines = 2;
  EXPECT_EQ(questions("[machine]\ngts = [1, 2, 3]\n") - questions("[machine]\ngts = 1\n"),
            kPictures * 2 * kTiles);
  EXPECT_EQ(questions("[machine]\nways = 2\n") - questions("[machine]\nways = 1\n"),
            kPictures * kTiles * kLines);
}

TEST(RunExperiment, APictureWhoseCellsAreNotAllThereIsCastAgain) {
  const ExperimentPlan plan = small_plan();
  const TemporaryFolder folder;
  const ExperimentRun whole = run_experiment(plan, folder / "r");
  write_file(folder / "r/cells.csv", cells_to_csv(std::span(whole.cells).first(6)));
  const ExperimentRun again = run_experiment(plan, folder / "r");
  EXPECT_EQ(again.found_before, 4U);
  EXPECT_EQ(again.cells, whole.cells);
}

TEST(RunExperiment, AnotherPlansFolderIsRefusedAndKept) {
  const TemporaryFolder folder;
  (void)run_experiment(small_plan(), folder / "r");
  const std::string cells = read_file(folder / "r/cells.csv");
  expect_refused(small_plan("[machine]\ngts = 2\n"), folder / "r", "another plan");
  EXPECT_EQ(read_file(folder / "r/cells.csv"), cells);
}

TEST(RunExperiment, DamagedResultsAreRefused) {
  const ExperimentPlan plan = small_plan();
  const TemporaryFolder folder;
  const ExperimentRun run = run_experiment(plan, folder / "r");
  const std::string csv = read_file(folder / "r/cells.csv");
  write_file(folder / "r/cells.csv", csv.substr(0, csv.size() / 2));
  expect_refused(plan, folder / "r", "cells.csv");
  std::vector<ExperimentCell> cells = run.cells;
  std::swap(cells[0], cells[5]);
  write_file(folder / "r/cells.csv", cells_to_csv(cells));
  expect_refused(plan, folder / "r", "is not the plan's");
  write_file(folder / "r/cells.csv", csv);
  write_file(folder / "r/experiment.json", "[1]");
  expect_refused(plan, folder / "r", "experiment.json");
  std::filesystem::remove(folder / "r/experiment.json");
  expect_refused(plan, folder / "r", "belongs to no plan");
  write_file(folder / "file", "");
  expect_refused(plan, folder / "file", "file");
}

TEST(RunExperiment, AMeshThatCannotBeVoxelisedIsNamed) {
  const TemporaryFolder folder;
  write_file(folder / "point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  const ExperimentPlan plan = parse_plan(R"([factors]
scenes = ["point.obj"]
depth = 3
tile = 2
lines = 64
resolution = "8x8"
)",
                                         "plan.toml", folder / "");
  EXPECT_THROW((void)run_experiment(plan, folder / "r"), Error);
}

TEST(AddressFigure, HasEveryNodesReadsOnce) {
  const ExperimentPlan plan = small_plan();
  const auto scenes = count_scene_reads(plan, no_progress());
  ASSERT_EQ(scenes.size(), 2U);
  EXPECT_EQ(scenes[0].nodes.front().address, 1U);
  EXPECT_EQ(scenes[0].nodes.back().level, 4);  // depth 5 is nearest to 8
  const Figure figure = figure_by_address(scenes).figure;
  ASSERT_EQ(figure.panels.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    const Series &mean = figure.panels[s].series[0], &most = figure.panels[s].series[1];
    ASSERT_EQ(mean.points.size(), most.points.size());
    EXPECT_EQ(mean.points[0].y, static_cast<double>(scenes[s].nodes[0].reads));
    for (std::size_t i = 0; i < mean.points.size(); ++i) {
      EXPECT_LE(mean.points[i].y, most.points[i].y);
      EXPECT_TRUE(i == 0 || mean.points[i].x > mean.points[i - 1].x);
    }
  }
}

}  // namespace
}  // namespace relumbre
