// `relumbre experiment` as a user meets it.

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_folder.h"

namespace relumbre {
namespace {

constexpr const char* kPlan = R"(title = "Teapots"
[factors]
scenes = ["builtin:teapots"]
depth = [4, 5, 6]
tile = [2, 20]
lines = [64, 4096]
resolution = ["80x60", "120x90"]
)";

class ExperimentCli : public testing::Test {
 protected:
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return folder_.run("experiment " + arguments);
  }
  void expect_refused(const std::string& plan, const std::string& reason) const {
    folder_.write("bad.toml", plan);
    const Outcome outcome = run("bad.toml -o bad");
    EXPECT_EQ(outcome.status, 1) << plan << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
    EXPECT_FALSE(folder_.exists("bad"));
  }
  static std::string with(std::string plan, const std::string& from, const std::string& to) {
    return plan.replace(plan.find(from), from.size(), to);
  }

  ProgramFolder folder_;
};

TEST_F(ExperimentCli, WritesCellsFiguresAndAReport) {
  folder_.write("plan.toml", kPlan);
  const Outcome outcome = run("plan.toml -o results --json r.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::json::parse(folder_.read("r.json"));
  EXPECT_EQ(report["planned"], 24);
  EXPECT_EQ(std::ranges::count(folder_.read("results/cells.csv"), '\n'), 25);
  const std::string html = folder_.read("results/report.html");
  for (const char* text : {"Teapots", "Kruskal-Wallis", "Read p with care", "<svg", "</html>"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  for (const char* figure : {"m-by-factor", "m-by-scene", "l-by-factor", "hit-rate-by-level",
                             "reads-by-address", "cache-size"})
    EXPECT_TRUE(folder_.exists("results/figures/" + std::string(figure) + ".svg")) << figure;
}

TEST_F(ExperimentCli, RunAgainItFindsItsCellsAndWritesTheSame) {
  folder_.write("plan.toml", kPlan);
  ASSERT_EQ(run("plan.toml -o results").status, 0);
  const std::string html = folder_.read("results/report.html");
  ASSERT_EQ(run("plan.toml -o results --json r.json").status, 0);
  EXPECT_EQ(nlohmann::json::parse(folder_.read("r.json"))["found"], 24);
  EXPECT_EQ(folder_.read("results/report.html"), html);
}

TEST_F(ExperimentCli, GoesOnAfterAnInterrupt) {
  folder_.write("long.toml",
                with(with(kPlan, "120x90", "1920x1080"), "4, 5, 6", "8, 9, 10, 11, 12"));
  const Outcome stopped = folder_.run_and_interrupt(1, "experiment long.toml -o results");
  if (stopped.status == 0) GTEST_SKIP() << "done before the interrupt";
  EXPECT_EQ(stopped.status, 130) << stopped.err;
  EXPECT_FALSE(folder_.exists("results/report.html"));
  EXPECT_EQ(run("long.toml -o results").status, 0);
  EXPECT_TRUE(folder_.exists("results/report.html"));
}

TEST_F(ExperimentCli, AFullDiskKeepsWhatWasThere) {
  folder_.write("plan.toml", kPlan);
  const Outcome outcome = folder_.run_on_full_disk(2048, "experiment plan.toml -o results");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  EXPECT_FALSE(folder_.exists("results/report.html"));
  EXPECT_EQ(run("plan.toml -o results").status, 0);
  EXPECT_TRUE(folder_.exists("results/report.html"));
}

TEST_F(ExperimentCli, BadPlansAreRefusedInOneLine) {
  expect_refused("", "bad.toml");
  expect_refused(with(kPlan, "tile =", "tiles ="), "tiles");
  expect_refused(with(kPlan, "[2, 20]", "[]"), "tile");
  expect_refused(with(kPlan, "[64, 4096]", "[64, 5000]"), "5000");
  expect_refused(with(kPlan, "builtin:teapots", "missing.ply"), "missing.ply");
  expect_refused(with(kPlan, "builtin:teapots", "builtin:nothing"), "nothing");
  EXPECT_EQ(run("none.toml -o bad").status, 1);
  EXPECT_EQ(run("none.toml").status, 2);
}

TEST_F(ExperimentCli, AFolderOfAnotherPlanIsKept) {
  folder_.write("plan.toml", kPlan);
  ASSERT_EQ(run("plan.toml -o results").status, 0);
  const std::string cells = folder_.read("results/cells.csv");
  folder_.write("other.toml", with(kPlan, "[2, 20]", "[2, 10]"));
  const Outcome outcome = run("other.toml -o results");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("another plan"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder_.read("results/cells.csv"), cells);
}

}  // namespace
}  // namespace relumbre
