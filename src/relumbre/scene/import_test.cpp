#include "relumbre/scene/import.h"

#include <bit>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/image/png.h"
#include "relumbre/image/srgb.h"
#include "relumbre/scene/test_gltf.h"

namespace relumbre {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Import : public ::testing::Test {
 protected:
  ImportResult import(const std::string& name, const std::string& text) {
    write_file(folder_ / name, text);
    return import_scene(folder_ / name);
  }

  TemporaryFolder folder_;
};

std::vector<std::string> names_of(const Scene& scene) {
  std::vector<std::string> names;
  for (const Object& object : scene.objects) names.push_back(object.name);
  return names;
}

constexpr const char* kTwoObjects =
    "mtllib scene.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    "o floor\nusemtl red\nf 1 2 3 4\n"
    "o lamp\nusemtl light\nf 1 2 3\n";

TEST_F(Import, ObjHasObjectsMaterialsAndEmitters) {
  write_file(folder_ / "scene.mtl",
             "newmtl red\nKd 0.6 0.1 0.2\n\nnewmtl light\nKd 0 0 0\nKe 10 20 30\n");
  const auto [scene, report] = import("scene.obj", kTwoObjects);
  EXPECT_THAT(names_of(scene), ElementsAre("floor", "lamp"));
  EXPECT_EQ(scene.mesh.triangles.size() + report.duplicate, 3U);
  EXPECT_EQ(scene.material_of(0).name, "red");
  EXPECT_EQ(scene.material_of(0).reflectance, Rgb(0.6F, 0.1F, 0.2F));
  EXPECT_EQ(scene.materials.back().emission, Rgb(10, 20, 30));
  EXPECT_THAT(report.warnings, IsEmpty());
}

TEST_F(Import, ObjIsTwoSidedUnlessSaidOtherwise) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(import("a.obj", obj).scene.mesh.two_sided[0], 1);
  ImportConfig config;
  config.sides = Sides::kOne;
  EXPECT_EQ(import_scene(folder_ / "a.obj", config).scene.mesh.two_sided[0], 0);
}

TEST_F(Import, ObjTextureIsUprightAndStandsInForABlackKd) {
  write_png(folder_ / "colours.png",
            std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}, 2, 2);
  write_file(folder_ / "t.mtl", "newmtl m\nKd 0 0 0\nmap_Kd colours.png\n");
  const Scene scene =
      import("t.obj",
             "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\n"
             "f 1/1 2/2 3/3\n")
          .scene;
  // At (0.75, 0.25) the lower right texel, white; at (0.75, 0.75) the upper right one, green.
  EXPECT_NEAR(scene.reflectance(0, 0.5F, 0.25F).x, 0.99F, 1e-5F);
  EXPECT_NEAR(scene.reflectance(0, 0.0F, 0.75F).x, 0, 1e-5F);
  EXPECT_NEAR(scene.reflectance(0, 0.0F, 0.75F).y, 0.99F, 1e-5F);
}

TEST_F(Import, ReflectanceOutsideOfItsRangeIsClampedAndNamed) {
  write_file(folder_ / "scene.mtl",
             "newmtl red\nKd 1.5 -0.25 nan\n\nnewmtl light\nKd 0.2 0.2 0.2\n");
  const auto [scene, report] = import("scene.obj", kTwoObjects);
  EXPECT_EQ(scene.materials.at(0).reflectance, Rgb(kMaxReflectance, 0, 0));
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("'red'")));
}

TEST_F(Import, MissingMaterialFileIsAWarningThatNamesIt) {
  const auto [scene, report] = import("scene.obj", kTwoObjects);
  EXPECT_EQ(scene.objects.size(), 2U);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("scene.mtl")));
}

TEST_F(Import, VertexColoursMultiplyWhiteWhereThereIsNoMaterial) {
  const Scene ply = import("c.ply",
                           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                           "property float y\nproperty float z\nproperty uchar red\n"
                           "property uchar green\nproperty uchar blue\nelement face 1\n"
                           "property list uchar int vertex_indices\nend_header\n"
                           "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 128 128 128\n3 0 1 2\n")
                        .scene;
  ASSERT_EQ(ply.colors.size(), 3U);
  const float grey = srgb_decode(128.0F / 255);
  EXPECT_NEAR(ply.reflectance(0, 0, 0).x, kMaxReflectance, 1e-5F);
  EXPECT_NEAR(ply.reflectance(0, 0, 0).y, 0, 1e-5F);
  EXPECT_NEAR(ply.reflectance(0, 1, 0).y, kMaxReflectance, 1e-5F);
  EXPECT_NEAR(ply.reflectance(0, 0, 1).z, kMaxReflectance * grey, 1e-4F);
  const Scene obj = import("c.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n").scene;
  EXPECT_NEAR(obj.reflectance(0, 0, 1).z, kMaxReflectance, 1e-5F);
  EXPECT_NEAR(obj.reflectance(0, 0, 1).x, 0, 1e-5F);
}

TEST_F(Import, PlyTextAndBinaryAgree) {
  const std::string header =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const Scene text = import("a.ply", "ply\nformat ascii 1.0\n" + header +
                                         "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
                         .scene;
  const Scene binary =
      import("b.ply", "ply\nformat binary_little_endian 1.0\n" + header +
                          gltf::bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + "\x04" +
                          gltf::bytes_of<std::int32_t>({0, 1, 2, 3}))
          .scene;
  EXPECT_EQ(text.mesh.triangles.size(), 2U);
  EXPECT_EQ(text.geometry_hash(), binary.geometry_hash());
  EXPECT_EQ(text.materials.at(0).reflectance, Rgb(0.5F));
  EXPECT_THAT(names_of(text), ElementsAre("a"));
}

TEST_F(Import, StlTextAndBinaryAgree) {
  const Scene text = import("a.stl",
                            "solid thing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                            "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid thing\n")
                         .scene;
  const Scene binary =
      import("b.stl", std::string(80, ' ') + gltf::bytes_of<std::uint32_t>({1}) +
                          gltf::bytes_of<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) +
                          std::string(2, '\0'))
          .scene;
  EXPECT_EQ(text.geometry_hash(), binary.geometry_hash());
  EXPECT_THAT(text.shading_normals, IsEmpty());
}

TEST_F(Import, UnusableTrianglesAreDroppedAndCounted) {
  const auto [scene, report] = import("a.obj",
                                      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 2 0 0\n"
                                      "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 2 3 1\nl 1 2\n");
  EXPECT_EQ(scene.mesh.triangles.size(), 1U);
  EXPECT_EQ(report.non_finite, 1U);
  EXPECT_EQ(report.degenerate, 1U);
  EXPECT_EQ(report.duplicate, 1U);
  EXPECT_EQ(report.points_and_lines, 1U);
  for (const Vec3f& p : scene.mesh.positions) EXPECT_TRUE(is_finite(p));
}

TEST_F(Import, CancelledWorkStops) {
  class Stop : public Progress {
    bool cancelled() const override { return true; }
  } stop;
  write_file(folder_ / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THROW(import_scene(folder_ / "a.obj", {}, stop), Cancelled);
}

TEST_F(Import, ConfigIsChecked) {
  ImportConfig config;
  config.scale = std::numeric_limits<float>::quiet_NaN();
  write_file(folder_ / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THROW(import_scene(folder_ / "a.obj", config), ValueError);
  config.scale = 1;
  config.default_reflectance = 1.5F;
  EXPECT_THROW(import_scene(folder_ / "a.obj", config), ValueError);
}

std::filesystem::path data_folder() {
  const char* const folder = std::getenv("RELUMBRE_DATA");
  return folder == nullptr ? "../shared/data" : folder;
}

TEST(ImportData, CornellBoxOfEmbree) {
  const auto file = data_folder() / "cornell/embree/cornell_box.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  ImportConfig config;
  config.scale = 0.001F;
  const auto [scene, report] = import_scene(file, config);
  EXPECT_EQ(scene.mesh.triangles.size() + report.duplicate + report.degenerate, 34U);
  EXPECT_THAT(names_of(scene), Contains("green_wall"));
  EXPECT_NEAR(bounds(scene.mesh.positions).upper.z, 0.5592F, 1e-6F);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("'white'")));
}

TEST(ImportData, Teapot) {
  const auto file = data_folder() / "teapot/teapot.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const auto [scene, report] = import_scene(file);
  EXPECT_EQ(scene.mesh.triangles.size() + report.duplicate + report.degenerate, 6320U);
}

}  // namespace
}  // namespace relumbre
