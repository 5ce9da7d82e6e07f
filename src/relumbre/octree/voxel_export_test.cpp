#include "relumbre/octree/voxel_export.h"

#include <cstring>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/octree/display_color.h"
#include "relumbre/octree/morton.h"
#include "relumbre/octree/palette.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/voxel_tree_builder.h"

namespace relumbre {
namespace {

using test::blocks_of, test::random_voxels;
using Place = std::tuple<int, int, int>;

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// All voxels of a .vox file: where they stand in the world, and their colour.
std::map<Place, Srgb8> read_vox(const std::string& bytes) {
  std::vector<std::string> models;
  std::vector<Place> places;
  std::string palette;
  EXPECT_EQ(bytes.substr(0, 4), "VOX ");
  for (std::size_t at = 20; at < bytes.size(); at += 12 + number_at(bytes, at + 4)) {
    const std::string id = bytes.substr(at, 4);
    const std::string content = bytes.substr(at + 12, number_at(bytes, at + 4));
    if (id == "XYZI") models.push_back(content.substr(4));
    if (id == "RGBA") palette = content;
    if (const auto t = content.find("_t"); id == "nTRN" && t != std::string::npos) {
      int x = 0, y = 0, z = 0;
      EXPECT_EQ(std::sscanf(content.substr(t + 6).c_str(), "%d %d %d", &x, &y, &z), 3);
      places.emplace_back(x, y, z);
    }
  }
  EXPECT_EQ(models.size(), places.size());
  std::map<Place, Srgb8> voxels;
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (std::size_t v = 0; v < models[m].size(); v += 4) {
      const auto byte = [&](std::size_t i) {
        return static_cast<int>(static_cast<unsigned char>(models[m][v + i]));
      };
      const auto [x, y, z] = places[m];
      Srgb8 color;
      std::memcpy(color.data(), palette.data() + 4 * (byte(3) - 1), 3);
      voxels[{x + byte(0), y + byte(1), z + byte(2)}] = color;
    }
  }
  return voxels;
}

TEST(VoxelExport, VoxFilesHoldEveryVoxelInItsPlace) {
  for (const unsigned depth : {3U, 8U, 10U}) {
    const TemporaryFolder folder;
    const auto codes = random_voxels(depth, 400);
    const VoxelTree tree = build_tree({}, depth, Separating::k26, blocks_of(codes, true));
    export_voxels(folder / "v.vox", tree);
    const auto voxels = read_vox(read_file(folder / "v.vox"));
    ASSERT_EQ(voxels.size(), codes.size());
    // A model's translation is of its centre.
    const int half_model = 1 << (std::min(depth, 8U) - 1), half = 1 << (depth - 1);
    for (const std::uint64_t code : codes) {
      const Cell cell = morton_decode(code);
      const Place place{static_cast<int>(cell.x) - half + half_model,
                        half - 1 - static_cast<int>(cell.z) + half_model,
                        static_cast<int>(cell.y) + half_model};
      ASSERT_TRUE(voxels.contains(place)) << depth;
      const Srgb8 expected = display_color(test::value_of(code), 1), found = voxels.at(place);
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(expected[c], found[c], 8) << depth;
    }
  }
}

TEST(VoxelExport, PointsAreTheVoxelsCentres) {
  const TemporaryFolder folder;
  const auto codes = random_voxels(4, 300);
  const Cube cube{Vec3d(1, 2, 3), 16};
  const VoxelTree tree = build_tree(cube, 4, Separating::k26, blocks_of(codes, true));
  export_voxels(folder / "v.ply", tree);
  const std::string bytes = read_file(folder / "v.ply");
  EXPECT_NE(bytes.find("element vertex " + std::to_string(codes.size()) + "\n"), std::string::npos);
  const std::size_t start = bytes.find("end_header\n") + 11, point = 12 + 3 + 12;
  ASSERT_EQ(bytes.size(), start + point * codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    float p[3];
    std::memcpy(p, bytes.data() + start + point * i, sizeof p);
    const Cell cell = morton_decode(codes[i]);
    EXPECT_EQ(p[0], 1 + static_cast<float>(cell.x) + 0.5F);
    EXPECT_EQ(p[1], 2 + static_cast<float>(cell.y) + 0.5F);
    EXPECT_EQ(p[2], 3 + static_cast<float>(cell.z) + 0.5F);
  }
}

TEST(VoxelExport, GeometryAloneIsWrittenToo) {
  const TemporaryFolder folder;
  const auto codes = random_voxels(4, 300);
  const VoxelTree tree = build_tree({}, 4, Separating::k26, blocks_of(codes, false));
  export_voxels(folder / "v.ply", tree);
  export_voxels(folder / "v.vox", tree);
  EXPECT_EQ(read_file(folder / "v.ply").find("red"), std::string::npos);
  EXPECT_EQ(read_vox(read_file(folder / "v.vox")).size(), codes.size());
}

TEST(VoxelExport, OtherFormatsAndDeepVoxFilesAreRefused) {
  EXPECT_THROW(check_export("a.obj", 5), FileError);
  EXPECT_THROW(check_export("a.vox", 12), FileError);
  EXPECT_NO_THROW(check_export("a.vox", 11));
  EXPECT_NO_THROW(check_export("a.ply", 16));
  const VoxelTree tree =
      build_tree({}, 1, Separating::k26, {.code = {0}, .mask = {1}, .value = {}});
  EXPECT_THROW(export_voxels("/nonexistent/a.ply", tree), FileError);
}

TEST(Palette, FewColoursAreKeptAsTheyAre) {
  Palette palette;
  const Srgb8 colors[] = {{0, 0, 0}, {255, 0, 8}, {16, 200, 100}};
  for (const Srgb8& c : colors) palette.count(c);
  palette.choose(255);
  EXPECT_EQ(palette.colors().size(), 3U);
  for (const Srgb8& c : colors) EXPECT_EQ(palette.colors()[palette.index(c)], c);
}

TEST(Palette, ManyColoursAreReplacedByNearOnes) {
  Palette palette;
  RandomStream random(1);
  std::vector<Srgb8> colors;
  for (int i = 0; i < 20'000; ++i) {
    const auto byte = [&] { return static_cast<std::uint8_t>(random.uniform() * 255); };
    colors.push_back({byte(), byte(), byte()});
    palette.count(colors.back());
  }
  palette.choose(255);
  EXPECT_EQ(palette.colors().size(), 255U);
  for (const Srgb8& c : colors) {
    const Srgb8& near = palette.colors()[palette.index(c)];
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(std::abs(c[k] - near[k]), 48);
  }
}

}  // namespace
}  // namespace relumbre
