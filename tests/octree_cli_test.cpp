// `relumbre voxelize`, and `info` and `raycast` on what it writes, as a user meets them.

#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_folder.h"
#include "relumbre/octree/morton.h"
#include "relumbre/octree/rlo_file.h"

namespace relumbre {
namespace {

class OctreeCli : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ProgramFolder;
    ASSERT_EQ(folder_->run("scene cornell -o c.glb").status, 0);
    ASSERT_EQ(folder_->run("bake c.glb -o c.h5 --patches 72 --elements 1152 --rays 64").status, 0);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static Outcome run(const std::string& arguments) { return folder_->run("voxelize " + arguments); }
  static nlohmann::json figures(const std::string& arguments) {
    const Outcome outcome = run(arguments + " --json f.json");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return nlohmann::json::parse(folder_->read("f.json"));
  }
  static void expect_refused(const std::string& arguments, const std::string& reason) {
    folder_->expect_refused("voxelize " + arguments, {reason});
  }

  inline static ProgramFolder* folder_ = nullptr;
};

/// Mean colour of all voxels.
Rgb mean_color(const VoxelTree& tree) {
  Rgb sum;
  for (const VoxelValue& v : tree.values())
    sum += unpack_color(v.color) / static_cast<float>(tree.values().size());
  return sum;
}

TEST_F(OctreeCli, WritesAnOctreeThatInfoDescribes) {
  const nlohmann::json made = figures("c.glb --depth 6 -o c6.rlo");
  const VoxelTree tree = read_rlo(*folder_ / "c6.rlo").tree;
  EXPECT_EQ(made["octree"]["voxels"], tree.voxels());
  EXPECT_EQ(made["octree"]["passes"], 1);
  const Outcome info = folder_->run("info c6.rlo --json i.json");
  ASSERT_EQ(info.status, 0) << info.err;
  const auto described = nlohmann::json::parse(folder_->read("i.json"))["octree"];
  for (const char* key : {"depth", "voxels", "nodes", "bytes_per_voxel", "cube", "build_s"})
    EXPECT_EQ(described[key], made["octree"][key]) << key;
  EXPECT_EQ(described["nodes"].size(), 3U);
}

TEST_F(OctreeCli, TheWallsKeepTheirColours) {
  ASSERT_EQ(run("c.glb --depth 5 -o c5.rlo").status, 0);
  const VoxelTree tree = read_rlo(*folder_ / "c5.rlo").tree;
  Rgb left, right;
  for_each_voxel(tree, [&](std::uint64_t code, std::uint64_t index) {
    const Cell cell = morton_decode(code);
    if (cell.y < 12 || cell.y > 20 || cell.z < 12 || cell.z > 20) return;
    const Rgb color = unpack_color(tree.values()[index].color);
    if (cell.x == 0) left = color;
    if (cell.x == 31) right = color;
  });
  const bool left_is_red = left.x > 2 * left.y && right.y > 2 * right.x;
  const bool right_is_red = right.x > 2 * right.y && left.y > 2 * left.x;
  EXPECT_TRUE(left_is_red || right_is_red);
}

TEST_F(OctreeCli, AStoresVoxelsHaveItsLight) {
  ASSERT_EQ(run("--store c.h5 --depth 5 -o lit.rlo").status, 0);
  ASSERT_EQ(run("--store c.h5 --no-scene-lights --lights dim.json --depth 5 -o x.rlo").status, 1);
  folder_->write("dim.json", R"([{"type": "point", "position": [0.5, 0.5, 0.5], "intensity": 1}])");
  const auto lit = read_rlo(*folder_ / "lit.rlo").tree;
  ASSERT_EQ(run("--store c.h5 --no-scene-lights --lights dim.json --depth 5 -o dim.rlo").status, 0)
      << folder_->read("err.txt");
  folder_->write("bright.json",
                 R"([{"type": "point", "position": [0.5, 0.5, 0.5], "intensity": 10}])");
  ASSERT_EQ(run("--store c.h5 --no-scene-lights --lights bright.json --depth 5 -o b.rlo").status,
            0);
  const Rgb dim = mean_color(read_rlo(*folder_ / "dim.rlo").tree);
  const Rgb bright = mean_color(read_rlo(*folder_ / "b.rlo").tree);
  EXPECT_GT(mean_color(lit).x, 0);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(bright[c] / dim[c], 10, 0.1);
}

TEST_F(OctreeCli, TheMemoryLimitDoesNotChangeTheFile) {
  ASSERT_EQ(run("c.glb --depth 9 --geometry-only -o one.rlo").status, 0);
  const VoxelTree one = read_rlo(*folder_ / "one.rlo").tree;
  ASSERT_EQ(run("c.glb --depth 9 --geometry-only --memory 120M -o many.rlo").status, 0);
  const VoxelTree many = read_rlo(*folder_ / "many.rlo").tree;
  EXPECT_TRUE(std::ranges::equal(one.leaves(), many.leaves()));
}

TEST_F(OctreeCli, WhatMemoryDoesNotAllowIsRefusedBeforeItStarts) {
  expect_refused("c.glb --depth 16 --memory 1G -o deep.rlo", "depth 16 needs about");
  expect_refused("c.glb --depth 5 --memory 10M -o deep.rlo", "--memory allows");
}

TEST_F(OctreeCli, ThinVoxelsAreFewer) {
  const auto thin = figures("c.glb --depth 7 --separating 6 -o thin.rlo");
  const auto all = figures("c.glb --depth 7 --separating 26 -o all.rlo");
  EXPECT_LT(thin["octree"]["voxels"], all["octree"]["voxels"]);
  EXPECT_EQ(thin["octree"]["separating"], 6);
}

TEST_F(OctreeCli, ExportsAreWrittenBeside) {
  ASSERT_EQ(run("c.glb --depth 6 -o e.rlo --export e.vox --export e.ply").status, 0);
  EXPECT_EQ(folder_->read("e.vox").substr(0, 4), "VOX ");
  EXPECT_EQ(folder_->read("e.ply").substr(0, 4), "ply\n");
  expect_refused("c.glb --depth 6 -o f.rlo --export e.stl", "e.stl");
  expect_refused("c.glb --depth 12 -o f.rlo --export f.vox", "MagicaVoxel");
}

TEST_F(OctreeCli, BadInputIsRefusedInOneLine) {
  expect_refused("missing.glb --depth 5 -o a.rlo", "missing.glb");
  expect_refused("--depth 5 -o a.rlo", "either a scene or --store");
  expect_refused("c.glb --store c.h5 --depth 5 -o a.rlo", "either a scene or --store");
  expect_refused("c.glb --depth 5 -o none/a.rlo", "none");
  EXPECT_EQ(run("c.glb --depth 17 -o a.rlo").status, 2);
  EXPECT_EQ(run("c.glb --depth 5 --memory -5 -o a.rlo").status, 2);
  EXPECT_EQ(run("c.glb --depth 5 --exposure abc -o a.rlo").status, 2);
  expect_refused("c.glb --depth 5 -o c.ply", "writes .rlo");
  folder_->write("own.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(folder_->shell("ln own.obj own.vox").status, 0);
  expect_refused("own.obj --depth 5 -o a.rlo --export own.vox", "is the scene itself");
  EXPECT_EQ(run("c.glb --separating 18 -o a.rlo").status, 2);
  folder_->write("bad.rlo", "not an octree");
  const Outcome info = folder_->run("info bad.rlo");
  EXPECT_EQ(info.status, 1);
  EXPECT_NE(info.err.find("bad.rlo: is not a Relumbre octree"), std::string::npos) << info.err;
}

TEST_F(OctreeCli, DegenerateMeshesAreVoxelisedOrRefused) {
  folder_->write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_GT(figures("one.obj --depth 5 -o one.rlo")["octree"]["voxels"], 32 * 32 / 2);
  folder_->write("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  expect_refused("point.obj --depth 5 -o p.rlo", "point.obj");
  folder_->write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_refused("nan.obj --depth 5 -o p.rlo", "nan.obj");
  EXPECT_EQ(figures("one.obj --depth 0 -o zero.rlo")["octree"]["voxels"], 1);
}

TEST_F(OctreeCli, RaycastShowsAnOctreeAndDofFocusesIt) {
  ASSERT_EQ(run("--store c.h5 --depth 7 -o room.rlo").status, 0);
  const Outcome cast = folder_->run(
      "raycast room.rlo --size 160x120 --smooth -o room.exr -o room.png --json r.json");
  ASSERT_EQ(cast.status, 0) << cast.err;
  const Image image = folder_->image("room.exr");
  EXPECT_EQ(image.width(), 160U);
  float alpha = 0;
  for (const float a : image.channel("A")) alpha += a / 19200;
  EXPECT_GT(alpha, 0.2F);
  const Outcome focused = folder_->run("dof room.exr --f-number 0.5 -o focused.png");
  EXPECT_EQ(focused.status, 0) << focused.err;
}

TEST_F(OctreeCli, RaycastDrawsHeatMapsOfEveryTraversal) {
  ASSERT_EQ(run("c.glb --depth 6 -o heat.rlo").status, 0);
  for (const char* traversal : {"restart", "backtrack", "full-stack", "short-stack --stack 2"}) {
    const Outcome outcome = folder_->run("raycast heat.rlo --size 80x60 --show reads --traversal " +
                                         std::string(traversal) + " -o heat.png --json h.json");
    ASSERT_EQ(outcome.status, 0) << traversal << outcome.err;
    EXPECT_GT(nlohmann::json::parse(folder_->read("h.json"))["reads"]["mean"], 1.0) << traversal;
  }
}

TEST_F(OctreeCli, RaycastRefusesBadInput) {
  ASSERT_EQ(run("c.glb --depth 3 -o r.rlo").status, 0);
  EXPECT_EQ(folder_->run("raycast r.rlo --size 10 -o r.png").status, 2);
  EXPECT_EQ(folder_->run("raycast r.rlo --traversal none -o r.png").status, 2);
  EXPECT_EQ(folder_->run("raycast r.rlo --show visits --detail 1 -o r.png").status, 2);
  EXPECT_EQ(folder_->run("raycast r.rlo -o r.gif").status, 1);
  EXPECT_EQ(folder_->run("raycast r.rlo --camera none.json -o r.png").status, 1);
  const Outcome missing = folder_->run("raycast missing.rlo -o r.png");
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.err.find("missing.rlo"), std::string::npos) << missing.err;
}

TEST_F(OctreeCli, AFullDiskLeavesNothingHalfWritten) {
  ASSERT_EQ(run("c.glb --depth 7 -o good.rlo").status, 0);
  const std::size_t before = folder_->files();
  for (const char* command : {"voxelize c.glb --depth 7 -o full.rlo",
                              "voxelize c.glb --depth 7 --geometry-only -o full.rlo",
                              "raycast good.rlo --size 640x480 -o full.exr"}) {
    const Outcome outcome = folder_->run_on_full_disk(20'000, command);
    EXPECT_EQ(outcome.status, 1) << command << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("full."), std::string::npos) << outcome.err;
    EXPECT_EQ(folder_->files(), before) << command;
  }
}

TEST_F(OctreeCli, AnInterruptLeavesNothingHalfWritten) {
  const std::size_t before = folder_->files();
  const Outcome outcome =
      folder_->run_and_interrupt(2, "voxelize c.glb --depth 13 --memory 40G -o stopped.rlo");
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_EQ(folder_->files(), before);
}

}  // namespace
}  // namespace relumbre
