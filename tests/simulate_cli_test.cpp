// `relumbre simulate` as a user meets it.

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_folder.h"

namespace relumbre {
namespace {

class SimulateCli : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ProgramFolder;
    ASSERT_EQ(folder_->run("scene teapots -o t.glb").status, 0);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static Outcome run(const std::string& arguments) { return folder_->run("simulate " + arguments); }
  static nlohmann::json figures(const std::string& arguments) {
    const Outcome outcome = run(arguments + " --json f.json");
    EXPECT_EQ(outcome.status, 0) << arguments << outcome.err;
    return nlohmann::json::parse(folder_->read("f.json"));
  }
  static void expect_refused(const std::string& arguments, const std::string& reason) {
    folder_->expect_refused("simulate " + arguments, {reason});
  }

  inline static ProgramFolder* folder_ = nullptr;
};

TEST_F(SimulateCli, CountsAddUp) {
  const auto report = figures("t.glb --depth 6 --size 97x61 --gts 3 --lines 64 --classify");
  const auto& picture = report["picture"];
  EXPECT_EQ(report["machine"]["gts"], 3);
  EXPECT_EQ(report["machine"]["lines"], 64);
  EXPECT_EQ(report["machine"]["traversal"], "machine");
  EXPECT_EQ(picture["rays"], 97 * 61);
  std::uint64_t reads = 0, misses = 0;
  ASSERT_EQ(report["levels"].size(), 6U);
  for (const auto& level : report["levels"]) {
    reads += level["reads"].get<std::uint64_t>();
    misses += level["misses"].get<std::uint64_t>();
    EXPECT_EQ(level["reads"],
              level["hits"].get<std::uint64_t>() + level["misses"].get<std::uint64_t>());
    EXPECT_EQ(level["misses"], level["compulsory"].get<std::uint64_t>() +
                                   level["capacity"].get<std::uint64_t>() +
                                   level["conflict"].get<std::uint64_t>());
    EXPECT_EQ(level["misses"], level["replacements"].get<std::uint64_t>() +
                                   level["lines_used"].get<std::uint64_t>());
  }
  EXPECT_EQ(picture["reads"], reads);
  EXPECT_EQ(report["proposed"]["fetches"], misses);
  EXPECT_EQ(report["proposed"]["bytes"], 2 * misses);
  EXPECT_EQ(report["naive_word"]["fetches"], reads);
  EXPECT_EQ(report["naive_pointer"]["fetches"], picture["tasks"]);
  EXPECT_EQ(report["naive_pointer"]["bytes"], 32 * picture["tasks"].get<std::uint64_t>());
  EXPECT_NEAR(report["proposed"]["hit_rate"],
              1 - static_cast<double>(misses) / static_cast<double>(reads), 1e-12);
}

TEST_F(SimulateCli, AnOctreeAndATraceOfItGiveTheMeshsFigures) {
  const auto mesh = figures("t.glb --depth 7 --size 80x60 --tile 7 --trace t.rlt");
  ASSERT_EQ(folder_->run("voxelize t.glb --depth 7 --geometry-only -o t.rlo").status, 0);
  const auto octree = figures("t.rlo --size 80x60 --tile 7"), trace = figures("t.rlt --tile 7");
  for (const char* section : {"proposed", "naive_word", "naive_pointer", "levels"}) {
    EXPECT_EQ(octree[section], mesh[section]) << section;
    EXPECT_EQ(trace[section], mesh[section]) << section;
  }
}

TEST_F(SimulateCli, ANaiveMachineAsksForWhatTheTraversalReads) {
  const auto machine = figures("t.glb --depth 6 --size 80x60");
  for (const char* traversal : {"restart", "backtrack", "full-stack", "short-stack --stack 2"}) {
    const auto report =
        figures("t.glb --depth 6 --size 80x60 --traversal " + std::string(traversal));
    EXPECT_GT(report["naive_word"]["fetches"], 0) << traversal;
    EXPECT_EQ(report["levels"][0]["misses"], 1) << traversal;
  }
  const auto restart = figures("t.glb --depth 6 --size 80x60 --traversal restart");
  EXPECT_GT(restart["picture"]["reads"], machine["picture"]["reads"]);
}

TEST_F(SimulateCli, MoreAndLargerCachesMissLess) {
  std::uint64_t last = ~std::uint64_t{0};
  for (const char* lines : {"64", "512", "4096", "262144"}) {
    const std::uint64_t misses = figures("t.glb --depth 8 --size 160x120 --lines " +
                                         std::string(lines))["proposed"]["fetches"];
    EXPECT_LE(misses, last) << lines;
    last = misses;
  }
  for (const char* machine :
       {"--ways 4", "--ways 0 --replacement fifo", "--ways 2 --replacement random"})
    EXPECT_GT(figures("t.glb --depth 6 --lines 64 --size 80x60 " +
                      std::string(machine))["proposed"]["fetches"],
              0);
}

TEST_F(SimulateCli, TheHeatMapHasThePixelsReads) {
  const auto report = figures("t.glb --depth 6 --size 64x48 --heat-map h.exr");
  const Image image = folder_->image("h.exr");
  double reads = 0;
  for (const float r : image.channel("reads")) reads += static_cast<double>(r);
  EXPECT_EQ(report["picture"]["reads"], reads);
}

TEST_F(SimulateCli, DinerosTextHasALineARead) {
  const auto report = figures("t.glb --depth 5 --size 32x24 --trace t.din");
  const std::string text = folder_->read("t.din");
  EXPECT_EQ(report["picture"]["reads"], std::ranges::count(text, '\n'));
  EXPECT_EQ(text.substr(0, 4), "0 2\n");
  ASSERT_EQ(run("t.glb --depth 5 --size 32x24 --trace l.din --trace-level 0").status, 0);
  EXPECT_EQ(report["levels"][0]["reads"], std::ranges::count(folder_->read("l.din"), '\n'));
}

TEST_F(SimulateCli, BadInputIsRefusedInOneLine) {
  expect_refused("missing.ply --depth 5", "missing.ply");
  expect_refused("t.glb --depth 5 --ways 3 --lines 64", "in sets of 3");
  expect_refused("t.glb --depth 5 --trace t.txt", ".rlt or .din");
  expect_refused("t.glb --depth 5 --trace none/t.rlt", "none");
  expect_refused("t.glb --depth 5 --heat-map h.jpg", "h.jpg");
  expect_refused("t.glb --depth 5 --trace u.din --trace-unit 1", "--trace-unit");
  EXPECT_EQ(run("t.glb --depth 0").status, 2);
  EXPECT_EQ(run("t.glb --depth 14").status, 2);
  EXPECT_EQ(run("t.glb --size 0x10").status, 1);
  EXPECT_EQ(run("t.glb --size ten").status, 2);
  EXPECT_EQ(run("t.glb --gts 0").status, 2);
  EXPECT_EQ(run("t.glb --tile 0").status, 2);
  EXPECT_EQ(run("t.glb --ways -1").status, 2);
  EXPECT_EQ(run("t.glb --stack 3").status, 2);
  EXPECT_EQ(run("t.glb --replacement fifo").status, 2);
  EXPECT_EQ(run("t.glb --ways 2 --seed 3").status, 2);
  EXPECT_EQ(run("t.glb --trace-level 2 --trace t.rlt").status, 2);
  expect_refused("t.glb --size 100000x100000", "100000");
  EXPECT_EQ(run("t.glb --traversal fast").status, 2);
}

TEST_F(SimulateCli, AFullDiskLeavesNothingHalfWritten) {
  const std::size_t before = folder_->files();
  for (const char* file : {"--trace full.rlt", "--trace full.din", "--heat-map full.exr"}) {
    const std::string command = "simulate t.glb --depth 7 --size 320x240 " + std::string(file);
    const Outcome outcome = folder_->run_on_full_disk(4096, command);
    EXPECT_EQ(outcome.status, 1) << file << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("full."), std::string::npos) << outcome.err;
    EXPECT_EQ(folder_->files(), before) << file;
  }
}

TEST_F(SimulateCli, ADamagedTraceIsRefused) {
  ASSERT_EQ(run("t.glb --depth 5 --size 32x24 --trace d.rlt").status, 0);
  std::string bytes = folder_->read("d.rlt");
  folder_->write("cut.rlt", bytes.substr(0, bytes.size() / 2));
  expect_refused("cut.rlt", "cut.rlt");
  bytes[bytes.size() - 3] = static_cast<char>(bytes[bytes.size() - 3] ^ 1);
  folder_->write("altered.rlt", bytes);
  expect_refused("altered.rlt", "altered.rlt");
  expect_refused("d.rlt --depth 5", "is a trace: not with --depth");
  expect_refused("d.rlt --stack 5", "is a trace: not with --stack");
  ASSERT_EQ(folder_->run("voxelize t.glb --depth 5 -o d.rlo").status, 0);
  expect_refused("d.rlo --separating 6", "not with --separating");
}

}  // namespace
}  // namespace relumbre
