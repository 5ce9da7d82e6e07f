#include "relumbre/experiment/plan.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/experiment/plan_hash.h"
#include "relumbre/scene/test_gltf.h"

namespace relumbre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kFactors = R"([factors]
scenes = ["builtin:cornell", "builtin:teapots"]
depth = [5, 6, 7]
tile = [2, 10]
lines = [512, 4096]
resolution = ["640x480", "800x600"]
)";

ExperimentPlan parse(const std::string& text) { return parse_plan(text, "plan.toml", "."); }

std::string refusal(const std::string& text) {
  try {
    (void)parse(text);
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

/// kFactors with one line replaced; the line's number in messages is that of the original.
std::string with(const std::string& key, const std::string& line) {
  std::string text = kFactors;
  const std::size_t begin = text.find("\n" + key + " =") + 1;
  return text.replace(begin, text.find('\n', begin) - begin, line);
}

TEST(Plan, ReadsEveryKey) {
  const ExperimentPlan plan = parse(R"toml(
title = "A title"
[factors]
scenes = [{name = "box", mesh = "builtin:cornell"}, "builtin:room"]
depth = 5
tile = [1, 65536]
lines = [3, 1000]
resolution = "16384x1"
[machine]
gts = [1, 8]
traversal = ["gt", "restart", "backtrack", "full-stack", "short-stack(3)"]
separating = 6
camera = "auto"
ways = "full"
replacement = "random"
)toml");
  EXPECT_EQ(plan.title, "A title");
  EXPECT_EQ(plan.scenes[0].name, "box");
  EXPECT_EQ(plan.scenes[0].builtin, "cornell");
  EXPECT_EQ(plan.scenes[1].name, "room");
  EXPECT_THAT(plan.depths, ElementsAre(5));
  EXPECT_THAT(plan.tiles, ElementsAre(1, 65536));
  EXPECT_THAT(plan.lines, ElementsAre(3, 1000));
  EXPECT_THAT(plan.resolutions, ElementsAre(Resolution{16384, 1}));
  EXPECT_THAT(plan.gts, ElementsAre(1, 8));
  std::vector<std::string> traversals;
  for (const PlannedTraversal& t : plan.traversals) traversals.push_back(to_string(t));
  EXPECT_THAT(traversals,
              ElementsAre("gt", "restart", "backtrack", "full-stack", "short-stack(3)"));
  EXPECT_EQ(plan.separating, 6);
  EXPECT_TRUE(plan.camera_file.empty());
  EXPECT_EQ(plan.ways, 0u);
  EXPECT_EQ(plan.replacement, Replacement::kRandom);
}

TEST(Plan, TheMachineHasDefaults) {
  const ExperimentPlan plan = parse(kFactors);
  EXPECT_THAT(plan.gts, ElementsAre(1));
  EXPECT_EQ(to_string(plan.traversals.at(0)), "gt");
  EXPECT_EQ(plan.separating, 26);
  EXPECT_EQ(plan.camera, "auto");
  EXPECT_EQ(plan.ways, 1u);
}

TEST(Plan, CellsAreEveryCombinationOnce) {
  const ExperimentPlan plan =
      parse(kFactors + "[machine]\ngts = [1, 2, 4]\ntraversal = [\"gt\", \"restart\"]\n");
  ASSERT_EQ(cell_count(plan), 2u * 3 * 2 * 2 * 2 * 3 * 2);
  std::set<std::vector<std::size_t>> seen;
  for (std::size_t i = 0; i < cell_count(plan); ++i) {
    const PlannedCell c = cell_at(plan, i);
    seen.insert({c.scene, c.depth, c.resolution, c.traversal, c.gts, c.tile, c.lines});
  }
  EXPECT_EQ(seen.size(), cell_count(plan));
  EXPECT_LT(seen.rbegin()->at(0), plan.scenes.size());
}

TEST(Plan, CellsOfOneTraversalAreNeighboursAndLinesChangeFastest) {
  const ExperimentPlan plan = parse(kFactors);
  EXPECT_EQ(cell_at(plan, 0), PlannedCell{});
  EXPECT_EQ(cell_at(plan, 1).lines, 1u);
  EXPECT_EQ(cell_at(plan, 2).tile, 1u);
  EXPECT_EQ(cell_at(plan, 4).resolution, 1u);
  EXPECT_EQ(cell_at(plan, 8).depth, 1u);
  EXPECT_EQ(cell_at(plan, 24).scene, 1u);
}

TEST(Plan, ErrorsNameFileLineAndKey) {
  EXPECT_EQ(refusal(with("depth", "depht = [5]")), "plan.toml:3: unknown key factors.depht");
  EXPECT_EQ(refusal(kFactors + "[machine]\nway = 1\n"), "plan.toml:8: unknown key machine.way");
  EXPECT_EQ(refusal("size = 3\n" + kFactors), "plan.toml:1: unknown key size");
  EXPECT_EQ(refusal(with("depth", "")), "plan.toml:1: factors.depth is missing");
  EXPECT_THAT(refusal("title = \"x\"\n"), HasSubstr("factors is missing"));
  EXPECT_EQ(refusal("factors = 3"), "plan.toml:1: factors is no table: write [factors]");
  EXPECT_THAT(refusal("[factors\n"), StartsWith("plan.toml:1: "));
  EXPECT_THAT(refusal(kFactors + "[factors]\n"), StartsWith("plan.toml:7: "));
  EXPECT_THAT(refusal("[^a]\n"), StartsWith("plan.toml:"));
  EXPECT_THAT(refusal(std::string("\xff\xfe\0", 3)), StartsWith("plan.toml:1: "));
}

TEST(Plan, NamesMayHaveAnyLetters) {
  EXPECT_EQ(parse("# ñ\ntitle = \"se\\\"ñor ~ ~c3 \\u00f1\" # ñ\n" + kFactors).title,
            "se\"ñor ~ ~c3 ñ");
  EXPECT_EQ(parse("title = '''€\n😀'''\n" + kFactors).title, "€\n😀");
  EXPECT_THAT(refusal("título = 1\n"), StartsWith("plan.toml:1: "));
  EXPECT_EQ(refusal("\"título\" = 1\n" + kFactors), "plan.toml:1: unknown key título");
}

TEST(Plan, RefusesLevelsThatCannotBe) {
  EXPECT_EQ(refusal(with("depth", "depth = []")), "plan.toml:3: factors.depth: the list is empty");
  EXPECT_EQ(refusal(with("depth", "depth = [5, 0]")),
            "plan.toml:3: factors.depth: 0 is not from 1 to 13");
  EXPECT_EQ(refusal(with("depth", "depth = [17]")),
            "plan.toml:3: factors.depth: 17 is not from 1 to 13");
  EXPECT_EQ(refusal(with("depth", "depth = [5, 6, 5]")),
            "plan.toml:3: factors.depth: 5 comes twice");
  EXPECT_EQ(refusal(with("depth", "depth = [\"5\"]")),
            "plan.toml:3: factors.depth: expected an integer, found string");
  EXPECT_THAT(refusal(with("depth", "depth = 5.0")), HasSubstr("found floating-point"));
  EXPECT_THAT(refusal(with("depth", "depth = [[5]]")), HasSubstr("found array"));
  EXPECT_THAT(refusal(with("depth", "depth = 99999999999999999999")), StartsWith("plan.toml:3: "));
  EXPECT_THAT(refusal(with("tile", "tile = [65537]")), HasSubstr("65537 is not from 1 to 65536"));
  EXPECT_EQ(refusal(with("lines", "lines = [512, 1000]")),
            "plan.toml:5: factors.lines: 1000 is no power of two");
  EXPECT_EQ(refusal(with("lines", "lines = 33554432")),
            "plan.toml:5: factors.lines: 33554432 is not from 1 to 16777216");
  for (const char* bad :
       {"640", "640x", "x480", "640x480x2", "-640x480", "640 x 480", "9999999999x1", "+1x1", ""})
    EXPECT_EQ(
        refusal(with("resolution", "resolution = [\"" + std::string(bad) + "\"]")),
        "plan.toml:6: factors.resolution: \"" + std::string(bad) + "\" is not like \"640x480\"");
  EXPECT_THAT(refusal(with("resolution", "resolution = \"0x480\"")),
              HasSubstr("0x480 has a side not from 1"));
  EXPECT_THAT(refusal(with("resolution", "resolution = \"20000x480\"")), HasSubstr("to 16384"));
  EXPECT_THAT(refusal(with("resolution", "resolution = 640")),
              HasSubstr("expected a string, found integer"));
  EXPECT_THAT(refusal(with("resolution", "resolution = [\"4x3\", \"04x3\"]")),
              HasSubstr("4x3 comes twice"));
}

TEST(Plan, RefusesMachinesThatCannotBe) {
  const auto machine = [](const std::string& line) {
    return refusal(kFactors + "[machine]\n" + line);
  };
  EXPECT_EQ(machine("separating = 18"), "plan.toml:8: machine.separating: 18 is neither 6 nor 26");
  EXPECT_THAT(machine("gts = 0"), HasSubstr("0 is not from 1 to 4096"));
  EXPECT_THAT(machine("ways = 3"), HasSubstr("3 is no power of two"));
  EXPECT_THAT(machine("ways = 1024"), HasSubstr("1024 is not from 1 to 512"));
  EXPECT_THAT(machine("ways = \"all\""), HasSubstr("\"full\" is the only word"));
  EXPECT_THAT(machine("replacement = \"plru\""),
              HasSubstr("\"plru\" is none of lru, fifo, random"));
  for (const char* bad :
       {"stack", "short-stack(0)", "short-stack(17)", "short-stack()", "short-stack", ""})
    EXPECT_THAT(machine("traversal = \"" + std::string(bad) + "\""),
                HasSubstr("is none of gt, restart"));
  EXPECT_THAT(machine("traversal = []"), HasSubstr("the list is empty"));
  EXPECT_THAT(machine("traversal = [\"gt\", \"gt\"]"), HasSubstr("gt comes twice"));
  EXPECT_THAT(machine("camera = \"nowhere.json\""),
              HasSubstr("nowhere.json: there is no such file"));
}

TEST(Plan, RefusesScenesThatAreNotThere) {
  EXPECT_EQ(refusal(with("scenes", "scenes = [\"builtin:palace\"]")),
            "plan.toml:2: factors.scenes: there is no built-in scene \"palace\"");
  EXPECT_THAT(refusal(with("scenes", "scenes = [\"missing.ply\"]")),
              HasSubstr("missing.ply: there is no such file"));
  EXPECT_THAT(refusal(with("scenes", "scenes = \".\"")), HasSubstr("no such file"));  // a folder
  EXPECT_THAT(refusal(with("scenes", "scenes = \"\"")), StartsWith("plan.toml:2: "));
  EXPECT_THAT(refusal(with("scenes", "scenes = []")), HasSubstr("the list is empty"));
  EXPECT_THAT(refusal(with("scenes", "scenes = [\"builtin:room\", \"builtin:room\"]")),
              HasSubstr("room comes twice"));
  EXPECT_THAT(refusal(with("scenes", "scenes = [{name = \"a\"}]")),
              HasSubstr("factors.scenes.mesh is missing"));
  EXPECT_THAT(refusal(with("scenes", "scenes = [{mesh = \"builtin:room\", colour = 1}]")),
              HasSubstr("unknown key factors.scenes.colour"));
  EXPECT_THAT(refusal(with("scenes", "scenes = [{mesh = \"builtin:room\", name = \"a\\nb\"}]")),
              HasSubstr("is no name of 1 to 80 bytes"));
}

TEST(Plan, RefusesTooManyCells) {
  std::string list = "[1";
  for (int i = 2; i <= 1000; ++i) list += ", " + std::to_string(i);
  const std::string tiles = with("tile", "tile = " + list + "]");
  EXPECT_THAT(refusal(tiles + "[machine]\ngts = " + list + "]"),
              HasSubstr("more than 1000000 cells"));
  EXPECT_THAT(refusal(with("tile", "tile = " + list + ", 1001]")),
              HasSubstr("1001 levels, at most 1000"));
  EXPECT_THAT(refusal(std::string(2 << 20, '#')), HasSubstr("2097152 bytes, at most 1048576"));
}

TEST(Plan, PathsStartFromThePlansFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "meshes");
  write_file(folder.path() / "meshes" / "bunny.ply", "ply");
  write_file(folder / "view.json", "{}");
  write_file(folder / "plan.toml", with("scenes", "scenes = [\"meshes/bunny.ply\"]") +
                                       "[machine]\ncamera = \"view.json\"\n");
  const ExperimentPlan plan = read_plan(folder / "plan.toml");
  EXPECT_EQ(plan.scenes[0].name, "bunny");
  EXPECT_TRUE(
      std::filesystem::equivalent(plan.scenes[0].mesh, folder.path() / "meshes" / "bunny.ply"));
  EXPECT_TRUE(std::filesystem::equivalent(plan.camera_file, folder / "view.json"));
  EXPECT_THROW((void)read_plan(folder / "other.toml"), FileError);
}

TEST(PlanHash, IsOfWhatRunsAndOfNothingElse) {
  const std::uint64_t hash = plan_hash(parse(kFactors));
  EXPECT_EQ(
      plan_hash(parse("# a comment\ntitle = \"other\"\n" + kFactors + "[machine]\ngts = 1\n")),
      hash);
  std::set<std::uint64_t> hashes{hash};
  for (const std::string& other :
       {with("depth", "depth = [5, 6]"), with("depth", "depth = [5, 7, 6]"),
        with("tile", "tile = 2"), with("lines", "lines = [512, 8192]"),
        with("resolution", "resolution = \"640x480\""), with("scenes", "scenes = \"builtin:room\""),
        with("scenes",
             "scenes = [{name = \"x\", mesh = \"builtin:cornell\"}, \"builtin:teapots\"]"),
        kFactors + "[machine]\ngts = 2", kFactors + "[machine]\ntraversal = \"restart\"",
        kFactors + "[machine]\nseparating = 6", kFactors + "[machine]\nways = 2",
        kFactors + "[machine]\nways = \"full\"", kFactors + "[machine]\nreplacement = \"fifo\""})
    EXPECT_TRUE(hashes.insert(plan_hash(parse(other))).second) << other;
}

/// The hash of kFactors with this mesh for a scene.
std::uint64_t hash_of_mesh(const TemporaryFolder& folder, const std::string& mesh) {
  const std::string text = with("scenes", "scenes = [{name = \"s\", mesh = \"" + mesh + "\"}]");
  return plan_hash(parse_plan(text, "plan.toml", folder.path()));
}

TEST(PlanHash, IsOfTheMeshesTrianglesNotOfTheirBytes) {
  const TemporaryFolder folder;
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const auto hash_of = [&](const std::string& text) {
    write_file(folder / "mesh.obj", text);
    return hash_of_mesh(folder, "mesh.obj");
  };
  const std::uint64_t hash = hash_of(corners + "f 1 2 3\n");
  EXPECT_EQ(hash_of("# a comment\n" + corners + "f 1 2 3\n"), hash);
  EXPECT_NE(hash_of(corners + "f 1 2 4\n"), hash);
  EXPECT_NE(hash_of(corners + "f 1 2 3\nf 1 2 4\n"), hash);
  EXPECT_NE(hash_of("v 0 0 0.5\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), hash);
}

TEST(PlanHash, ChangesWithTheFilesThatAMeshPointsTo) {
  const TemporaryFolder folder;
  nlohmann::json square = gltf::square();
  square["buffers"][0]["uri"] = "square.bin";
  write_file(folder / "square.gltf", square.dump());
  std::string bytes = gltf::bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3});
  bytes.resize(16);
  bytes += gltf::bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  bytes.resize(128);
  write_file(folder / "square.bin", bytes);
  const std::uint64_t before = hash_of_mesh(folder, "square.gltf");
  EXPECT_EQ(hash_of_mesh(folder, "square.gltf"), before);
  const std::string moved = gltf::bytes_of<float>({0.25F});
  write_file(folder / "square.bin", bytes.replace(16, moved.size(), moved));
  EXPECT_NE(hash_of_mesh(folder, "square.gltf"), before);
}

TEST(PlanHash, ChangesWithTheCamerasBytes) {
  const TemporaryFolder folder;
  const auto hash_of = [&](const std::string& camera) {
    write_file(folder / "view.json", camera);
    return plan_hash(
        parse_plan(kFactors + "[machine]\ncamera = \"view.json\"\n", "plan.toml", folder.path()));
  };
  EXPECT_NE(hash_of("{}"), hash_of("{ }"));
}

TEST(Plan, TheExamplesAreWhatTheySay) {
  const std::filesystem::path folder = std::filesystem::path(RELUMBRE_EXAMPLES) / "experiments";
  EXPECT_EQ(cell_count(read_plan(folder / "small.toml")), 48u);
  // The meshes are not part of the tree: files of their names stand for them.
  const TemporaryFolder copy;
  std::filesystem::create_directory(copy / "meshes");
  for (const char* mesh : {"teapot.obj", "bun_zipper.ply", "dragon_q11.ply", "happy_buddha.obj"})
    write_file(copy.path() / "meshes" / mesh, "mesh");
  std::filesystem::copy_file(folder / "thesis.toml", copy / "thesis.toml");
  EXPECT_EQ(cell_count(read_plan(copy / "thesis.toml")), 1920u);
}

}  // namespace
}  // namespace relumbre
