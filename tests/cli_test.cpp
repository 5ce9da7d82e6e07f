// The program as a user meets it: exit statuses, one-line errors, nothing half-written.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_folder.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/npy.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;

class Cli : public testing::Test {
 protected:
  Outcome run(const std::string& arguments) const { return folder_.run(arguments); }
  Outcome shell(const std::string& command) const { return folder_.shell(command); }
  Outcome run_on_full_disk(std::size_t bytes, const std::string& arguments) const {
    return folder_.run_on_full_disk(bytes, arguments);
  }
  const fs::path& folder() const { return folder_.path(); }
  std::string read(const std::string& name) const { return folder_.read(name); }
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  bool exists(const std::string& name) const { return folder_.exists(name); }
  std::size_t files() const { return folder_.files(); }
  void bake_cornell(const std::string& options = "--patches 72 --elements 288 --rays 64") const {
    ASSERT_EQ(run("scene cornell -o c.glb").status, 0);
    const Outcome baked = run("bake c.glb -o c.h5 " + options);
    ASSERT_EQ(baked.status, 0) << baked.err;
  }
  /// Bad input: status 1, one line on standard error that names `file` and holds `reason`.
  void expect_refused(const std::string& arguments, const std::string& file,
                      const std::string& reason) const {
    expect_refusal(run(arguments), arguments, file, reason);
  }
  static void expect_refusal(const Outcome& outcome, const std::string& arguments,
                             const std::string& file, const std::string& reason) {
    EXPECT_EQ(outcome.status, 1) << arguments << "\n" << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
  }

 private:
  ProgramFolder folder_;
};

const char* const kCommands[] = {"scene",   "info",     "viewfactors", "bake",    "relight",
                                 "solve",   "render",   "dof",         "compare", "voxelize",
                                 "raycast", "simulate", "experiment"};

TEST_F(Cli, EveryCommandHasHelpWithAnExample) {
  for (const char* command : kCommands) {
    const Outcome help = run(std::string(command) + " --help");
    EXPECT_EQ(help.status, 0) << command;
    EXPECT_NE(help.out.find("Example:\n  relumbre " + std::string(command)), std::string::npos)
        << help.out;
    EXPECT_NE(help.out.find("--json"), std::string::npos) << command;
    EXPECT_NE(help.out.find("--threads"), std::string::npos) << command;
  }
}

TEST_F(Cli, WrongUsageExitsWithTwo) {
  EXPECT_EQ(run("").status, 2);
  EXPECT_EQ(run("no-such-command").status, 2);
  EXPECT_EQ(run("bake").status, 2);
  EXPECT_EQ(run("bake a.glb -o b.h5 --rays many").status, 2);
  EXPECT_EQ(run("scene cornell").status, 2);
}

TEST_F(Cli, CornellGoesFromSceneToPicture) {
  bake_cornell();
  EXPECT_FALSE(exists("c.h5.partial"));
  EXPECT_EQ(run("relight c.h5 -o B.npy").status, 0);
  const FloatArray b = read_npy(folder() / "B.npy");
  EXPECT_EQ(b.shape, (std::vector<std::size_t>{288, 3}));
  for (const char* output : {"b.ply", "b.glb"})
    EXPECT_EQ(run(std::string("relight c.h5 -o ") + output).status, 0);
  EXPECT_EQ(run("render c.h5 --size 64x48 --samples 1 -o v.exr -o v.png").status, 0);
  EXPECT_EQ(run("compare v.exr v.exr").status, 0);
  EXPECT_EQ(run("solve c.h5 -o S.npy").status, 0);
  EXPECT_EQ(run("info c.h5 --error").status, 0);
  EXPECT_EQ(run("info c.glb").status, 0);
}

TEST_F(Cli, JsonOnStandardOutputIsNothingButJson) {
  bake_cornell();
  for (const char* arguments :
       {"info c.h5 --json -", "relight c.h5 -o B.npy --json -", "scene --list --json -"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(nlohmann::json::accept(outcome.out)) << outcome.out;
  }
}

TEST_F(Cli, DimmingCostsNoRays) {
  bake_cornell();
  write("full.json", R"([{"name":"lamp","type":"scene","intensity":1}])");
  write("dim.json", R"([{"name":"lamp","type":"scene","intensity":0.25,"color":[1,0.5,0.5]}])");
  ASSERT_EQ(run("relight c.h5 --lights full.json -o full.npy").status, 0);
  const Outcome dimmed = run("relight c.h5 --lights dim.json -o dim.npy --json -");
  ASSERT_EQ(dimmed.status, 0) << dimmed.err;
  EXPECT_EQ(nlohmann::json::parse(dimmed.out)["light_rays"], 0);
  const FloatArray a = read_npy(folder() / "full.npy"), b = read_npy(folder() / "dim.npy");
  for (std::size_t i = 0; i < a.data.size(); i += 3) {
    EXPECT_NEAR(b.data[i], 0.25F * a.data[i], 1e-4F * a.data[i] + 1e-6F);
    EXPECT_NEAR(b.data[i + 1], 0.125F * a.data[i + 1], 1e-4F * a.data[i + 1] + 1e-6F);
  }
}

TEST_F(Cli, ReflectanceEditTracesNothingAndDarkens) {
  bake_cornell();
  ASSERT_EQ(run("relight c.h5 -o white.npy").status, 0);
  const Outcome edited = run("relight c.h5 --reflectance white=0.1,0.1,0.1 -o dark.npy --json -");
  ASSERT_EQ(edited.status, 0) << edited.err;
  EXPECT_EQ(nlohmann::json::parse(edited.out)["light_rays"], 0);
  double white = 0, dark = 0;
  for (const float v : read_npy(folder() / "white.npy").data) white += v;
  for (const float v : read_npy(folder() / "dark.npy").data) dark += v;
  EXPECT_LT(dark, 0.9 * white);
}

TEST_F(Cli, BadScenesAreRefusedInOneLine) {
  write("empty.obj", "");
  write("text.stl", "this is no mesh");
  write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("none.obj", "v 0 0 0\nv 1 0 0\n");
  write("cut.glb", std::string("glTF\x02\0\0\0\xff\xff\0\0", 12));
  write("scene.xyz", "1 2 3");
  expect_refused("bake missing.glb -o s.h5", "missing.glb", "no such file");
  for (const char* file :
       {"empty.obj", "text.stl", "nan.obj", "none.obj", "cut.glb", "scene.xyz"}) {
    expect_refused(std::string("bake ") + file + " -o s.h5", file, "");
    EXPECT_FALSE(exists("s.h5"));
  }
}

TEST_F(Cli, BadSizesAreRefusedBeforeTracing) {
  ASSERT_EQ(run("scene cornell -o c.glb").status, 0);
  expect_refused("bake c.glb -o s.h5 --patches 100 --elements 50", "100", "50");
  expect_refused("bake c.glb -o s.h5 --patches 0", "", "");
  expect_refused("bake c.glb -o s.h5 --rays 0", "", "");
  expect_refused("bake c.glb -o no-such-folder/s.h5", "no-such-folder/s.h5", "folder");
  EXPECT_EQ(files(), 1U);
}

TEST_F(Cli, BadStoresAreRefused) {
  bake_cornell();
  const std::string good = read("c.h5");
  write("cut.h5", good.substr(0, good.size() / 2));
  std::string flipped = good;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x10);
  write("flipped.h5", flipped);
  write("other.h5", "not HDF5 at all");
  for (const char* file : {"cut.h5", "flipped.h5", "other.h5"}) {
    expect_refused(std::string("relight ") + file + " -o B.npy", file, "");
    EXPECT_FALSE(exists("B.npy"));
  }
}

TEST_F(Cli, BadEmissionIsRefused) {
  bake_cornell();
  const std::vector<std::size_t> wrong = {287, 3}, right = {288, 3};
  write_npy(folder() / "wrong.npy", wrong, std::vector<float>(287 * 3, 1.0F));
  std::vector<float> values(288 * 3, 1.0F);
  values[100] = std::numeric_limits<float>::quiet_NaN();
  write_npy(folder() / "nan.npy", right, values);
  expect_refused("relight c.h5 --emission wrong.npy -o B.npy", "wrong.npy", "288");
  expect_refused("relight c.h5 --emission nan.npy -o B.npy", "nan.npy", "NaN");
  expect_refused("relight c.h5 --no-scene-lights -o B.npy", "c.h5", "no lights");
  EXPECT_FALSE(exists("B.npy"));
}

TEST_F(Cli, SeveralSourcesEqualEachAlone) {
  bake_cornell();
  std::vector<float> values(2 * 288 * 3);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>((i * 7) % 11);
  write_npy(folder() / "two.npy", std::vector<std::size_t>{2, 288, 3}, values);
  write_npy(folder() / "second.npy", std::vector<std::size_t>{288, 3},
            std::span(values).subspan(288 * 3));
  ASSERT_EQ(run("relight c.h5 --emission two.npy -o B2.npy").status, 0);
  ASSERT_EQ(run("relight c.h5 --emission second.npy -o B1.npy").status, 0);
  const FloatArray both = read_npy(folder() / "B2.npy"), one = read_npy(folder() / "B1.npy");
  for (std::size_t i = 0; i < one.data.size(); ++i) EXPECT_EQ(both.data[288 * 3 + i], one.data[i]);
}

TEST_F(Cli, ResumedBakeEqualsUninterruptedOne) {
  ASSERT_EQ(run("scene room -o r.glb").status, 0);
  const std::string bake = "bake r.glb --patches 200 --elements 6000 --rays 4096 -o ";
  ASSERT_EQ(run(bake + "whole.h5").status, 0);
  // Killed without warning after some blocks are on disk, then gone on with.
  shell(std::string(RELUMBRE_PROGRAM) + " " + bake +
        "cut.h5 & pid=$!; for i in $(seq 400); do sleep 0.02; "
        "[ -s cut.h5.partial ] && [ $(stat -c %s cut.h5.partial) -gt 100000 ] && break; done; kill "
        "-9 $pid; wait $pid");
  ASSERT_TRUE(exists("cut.h5.partial"));
  ASSERT_FALSE(exists("cut.h5"));
  const Outcome resumed = run(bake + "cut.h5 --resume");
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_FALSE(exists("cut.h5.partial"));
  ASSERT_EQ(run("relight whole.h5 -o whole.npy").status, 0);
  ASSERT_EQ(run("relight cut.h5 -o cut.npy").status, 0);
  EXPECT_EQ(read("whole.npy"), read("cut.npy"));
}

TEST_F(Cli, InterruptKeepsFinishedRows) {
  ASSERT_EQ(run("scene room -o r.glb").status, 0);
  const Outcome outcome = shell(std::string(RELUMBRE_PROGRAM) +
                                " bake r.glb --patches 200 --elements 6000 --rays 8192 -o s.h5 & "
                                "pid=$!; for i in $(seq 400); do "
                                "sleep 0.02; [ -s s.h5.partial ] && [ $(stat -c %s s.h5.partial) "
                                "-gt 100000 ] && break; done; "
                                "kill -INT $pid; wait $pid");
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_TRUE(exists("s.h5.partial"));
  EXPECT_FALSE(exists("s.h5"));
  EXPECT_NE(outcome.err.find("--resume"), std::string::npos) << outcome.err;
  expect_refused("bake r.glb --patches 200 --elements 6000 --rays 16 --resume -o s.h5",
                 "s.h5.partial", "");
}

TEST_F(Cli, UnwritableFolderIsRefusedBeforeTheWork) {
  ASSERT_EQ(run("scene cornell -o c.glb").status, 0);
  expect_refused("scene cornell -o /proc/nowhere/c.glb", "/proc/nowhere/c.glb", "");
  expect_refused("bake c.glb -o /proc/c.h5", "/proc/c.h5", "");
}

class FullDisk : public Cli {
 protected:
  const std::string bake_ = "bake r.glb --patches 200 --elements 3000 --rays 256 -o ";

  void SetUp() override {
    ASSERT_EQ(run("scene room -o r.glb").status, 0);
    ASSERT_EQ(run(bake_ + "whole.h5").status, 0);
  }
  /// A bake that ends for want of room keeps its journal, names `file`, and can be gone on with.
  void expect_resumable(std::size_t bytes, const std::string& file) const {
    expect_refusal(run_on_full_disk(bytes, bake_ + "cut.h5"), bake_, file, "File too large");
    EXPECT_FALSE(exists("cut.h5"));
    EXPECT_TRUE(exists("cut.h5.partial"));
    EXPECT_EQ(files(), 3U);  // r.glb and whole.h5 beside it
    const Outcome resumed = run(bake_ + "cut.h5 --resume --json -");
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_GT(nlohmann::json::parse(resumed.out)["bake"]["resumed_rows"], 0);
    EXPECT_FALSE(exists("cut.h5.partial"));
    EXPECT_TRUE(read("cut.h5") == read("whole.h5"));
  }
};

TEST_F(FullDisk, WhileTracingKeepsFinishedRowsForAnIdenticalStore) {
  expect_resumable(200 * 1024, "cut.h5.partial: ");
}

TEST_F(FullDisk, WhileWritingTheStoreKeepsTheRowsForAnIdenticalStore) {
  expect_resumable(fs::file_size(folder() / "whole.h5") - 1024, "cut.h5: ");
}

TEST_F(Cli, FullDiskKeepsTheFormerFile) {
  bake_cornell();
  ASSERT_EQ(run("relight c.h5 -o B.npy").status, 0);  // fills the cache
  const std::string before = "what was here";
  for (const std::string command :
       {"relight c.h5 -o out.npy", "relight c.h5 -o out.ply", "relight c.h5 -o out.glb",
        "solve c.h5 -o out.npy", "render c.h5 --size 64x48 --samples 1 -o out.exr",
        "render c.h5 --size 64x48 --samples 1 -o out.png", "scene cornell -o out.glb"}) {
    const std::string output = command.substr(command.rfind(' ') + 1);
    write(output, before);
    const std::size_t count = files();
    expect_refusal(run_on_full_disk(2048, command), command, output, "");
    EXPECT_EQ(read(output), before) << command;
    EXPECT_EQ(files(), count) << command;
  }
}

TEST_F(Cli, CacheOfLightsThatCannotBeWrittenIsDoneWithout) {
  bake_cornell();
  const std::string render = "render c.h5 --size 16x12 --samples 1 -o v.png";
  const Outcome full = run_on_full_disk(2048, render);
  EXPECT_EQ(full.status, 0) << full.err;
  EXPECT_TRUE(fs::is_empty(folder() / "c.h5.lights"));
  const std::string picture = read("v.png");
  fs::remove(folder() / "c.h5.lights");
  write("c.h5.lights", "a file in the folder's place");
  const Outcome blocked = run(render);
  EXPECT_EQ(blocked.status, 0) << blocked.err;
  EXPECT_EQ(read("v.png"), picture);
}

TEST_F(Cli, OutputsInUnwritableFoldersAreRefused) {
  bake_cornell();
  for (const std::string folder : {"/proc/", "no-such-folder/"}) {
    for (const std::string command :
         {"relight c.h5 -o B.npy", "relight c.h5 -o b.ply", "relight c.h5 -o b.glb",
          "solve c.h5 -o S.npy", "render c.h5 --size 16x12 --samples 1 -o v.exr",
          "render c.h5 --size 16x12 --samples 1 -o v.png"}) {
      const std::size_t at = command.rfind(' ') + 1;
      const std::string output = folder + command.substr(at);
      expect_refused(command.substr(0, at) + output, output, "");
    }
  }
}

}  // namespace
}  // namespace relumbre
