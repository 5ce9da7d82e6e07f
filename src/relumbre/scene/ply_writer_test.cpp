#include "relumbre/scene/ply_writer.h"

#include <array>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/scene/import.h"

namespace relumbre {
namespace {

class PlyWriter : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) /
      ("relumbre_ply_" +
       std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5F}};
  const std::vector<Index3> triangles{{0, 1, 2}, {0, 2, 3}};
  const std::vector<Rgb> colors{{0, 0.5F, 1}, {2, -1, 0.2F}, {1, 1, 1}, {0.1F, 0.1F, 0.1F}};
};

template <class T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

TEST_F(PlyWriter, LaysOutWhatItsHeaderSays) {
  write_ply(folder / "a.ply", {positions, triangles, colors, colors});
  const std::string bytes = read_file(folder / "a.ply");
  const std::size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 4 * (12 + 3 + 12) + 2 * 13);
  const std::size_t second = body + 27;
  EXPECT_EQ(value_at<float>(bytes, second), 1.0F);
  EXPECT_EQ(value_at<std::uint8_t>(bytes, body + 13), 188);  // sRGB of 0.5
  EXPECT_EQ(value_at<std::uint8_t>(bytes, second + 12), 255);
  EXPECT_EQ(value_at<std::uint8_t>(bytes, second + 13), 0);
  EXPECT_EQ(value_at<float>(bytes, second + 15), 2.0F);
  EXPECT_EQ(value_at<float>(bytes, second + 19), -1.0F);
  const std::size_t faces = body + 4 * 27;
  EXPECT_EQ(value_at<std::uint8_t>(bytes, faces + 13), 3);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, faces + 13 + 9), 3U);
}

TEST_F(PlyWriter, ReadsBackAsTheSameMesh) {
  write_ply(folder / "a.ply", {positions, triangles, {}, {}});
  const Scene scene = import_scene(folder / "a.ply").scene;
  ASSERT_EQ(scene.mesh.triangles.size(), triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(scene.mesh.corner(t, i), positions[triangles[t][i]]);
}

TEST_F(PlyWriter, RefusesSizesThatDisagreeAndLeavesNothing) {
  const auto file = folder / "a.ply";
  EXPECT_THROW(write_ply(file, {positions, triangles, std::span(colors).first(3), {}}), ShapeError);
  EXPECT_THROW(write_ply(file, {positions, triangles, {}, std::span(colors).first(1)}), ShapeError);
  EXPECT_THROW(write_ply(file, {std::span(positions).first(3), triangles, {}, {}}), ShapeError);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(PlyWriter, NamesTheFileItCannotWrite) {
  try {
    write_ply(folder / "missing" / "a.ply", {positions, triangles, {}, {}});
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("a.ply"), std::string::npos);
  }
}

}  // namespace
}  // namespace relumbre
