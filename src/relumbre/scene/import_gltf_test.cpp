#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/image/png.h"
#include "relumbre/scene/gltf_document.h"
#include "relumbre/scene/import.h"
#include "relumbre/scene/test_gltf.h"

namespace relumbre {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ImportGltf : public ::testing::Test {
 protected:
  ImportResult import(const json& document, const ImportConfig& config = {}) {
    write_file(folder_ / "scene.gltf", document.dump());
    return import_scene(folder_ / "scene.gltf", config);
  }

  static json with_material(const json& material) {
    json document = gltf::square();
    document["materials"] = json::array({material});
    document["meshes"][0]["primitives"][0]["material"] = 0;
    return document;
  }

  /// The square with a light or camera node beside it, moved to (1, 2, 3) and turned so that its -z
  /// looks along -y.
  static json with_node(const json& content) {
    json document = gltf::square();
    const double half = std::sqrt(0.5);
    json node = content;
    node["translation"] = {1, 2, 3};
    node["rotation"] = {-half, 0, 0, half};
    document["nodes"].push_back(node);
    document["scenes"][0]["nodes"] = {0, 1};
    return document;
  }

  static json with_light(const json& light) {
    json document =
        with_node({{"name", "lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    document["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
    return document;
  }

  TemporaryFolder folder_;
};

void expect_near(const Vec3f& a, const Vec3f& b, float tolerance = 1e-6F) {
  EXPECT_LE(length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " for " << b.x << " " << b.y << " " << b.z;
}

TEST_F(ImportGltf, VertexColoursAreLinearFactorsOfTheBaseColour) {
  json document = gltf::square();
  document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 1;  // the positions, as colours
  const auto [plain, report] = import(document);
  EXPECT_THAT(report.warnings, IsEmpty());
  ASSERT_EQ(plain.colors.size(), plain.mesh.positions.size());
  for (std::size_t i = 0; i < plain.colors.size(); ++i)
    EXPECT_EQ(plain.colors[i], plain.mesh.positions[i]);
  EXPECT_EQ(plain.materials.at(0).reflectance, Rgb(kMaxReflectance));
  json colored = with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0, 1}}}}});
  colored["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 1;
  const Scene scene = import(colored).scene;
  expect_near(scene.reflectance(0, 0.5F, 0.5F), Rgb(0.5F * 1, 0.5F * 0.5F, 0));
}

TEST_F(ImportGltf, VertexColoursOfOtherTypesAreLeftOutWithAWarning) {
  json document = gltf::square();
  document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2;  // VEC2
  const auto [scene, report] = import(document);
  EXPECT_THAT(scene.colors, IsEmpty());
  EXPECT_THAT(report.warnings, Contains(HasSubstr("vertex colours")));
}

TEST_F(ImportGltf, ReadsASquareWithItsWinding) {
  const auto [scene, report] = import(gltf::square());
  ASSERT_EQ(scene.mesh.triangles.size(), 2U);
  for (std::size_t t = 0; t < 2; ++t) expect_near(scene.mesh.scaled_normal(t), {0, 0, 1});
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.objects[0].name, "square");
  EXPECT_EQ(scene.materials.at(0).reflectance, Rgb(0.5F));
  EXPECT_FALSE(scene.materials[0].two_sided);
  EXPECT_THAT(report.warnings, IsEmpty());
  EXPECT_THAT(scene.lights, IsEmpty());
}

TEST_F(ImportGltf, BinaryContainerGivesTheSameScene) {
  json document = gltf::square();
  const Scene from_text = import(document).scene;
  GltfDocument binary;
  binary.binary_container = true;
  const std::string square =
      gltf::bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3}) + std::string(4, '\0') +
      gltf::bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
      gltf::bytes_of<float>({0, 1, 1, 1, 1, 0, 0, 0}) + std::string(32, '\0');
  binary.bytes = square;
  binary.bin_size = square.size();
  document["buffers"][0].erase("uri");
  binary.json = document;
  write_file(folder_ / "scene.glb", serialize(binary, "scene.glb"));
  const Scene from_binary = import_scene(folder_ / "scene.glb").scene;
  EXPECT_EQ(from_binary.geometry_hash(), from_text.geometry_hash());
}

TEST_F(ImportGltf, AppliesNodeTransformsAndUnits) {
  json document = gltf::square();
  document["nodes"] = json::parse(R"([{"children":[1],"translation":[10,0,0]},
                                      {"mesh":0,"scale":[2,3,1],"translation":[0,0,5]}])");
  ImportConfig config;
  config.scale = 0.5F;
  const Scene scene = import(document, config).scene;
  Box box = bounds(scene.mesh.positions);
  expect_near(box.lower, {5, 0, 2.5F});
  expect_near(box.upper, {6, 1.5F, 2.5F});
}

TEST_F(ImportGltf, MirroringKeepsTheFrontInFront) {
  json document = gltf::square();
  document["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene scene = import(document).scene;
  for (std::size_t t = 0; t < 2; ++t) expect_near(scene.mesh.scaled_normal(t), {0, 0, 1});
}

TEST_F(ImportGltf, InstancesBecomeObjectsWithUniqueNames) {
  json document = gltf::square();
  document["nodes"] = json::parse(R"([{"mesh":0,"name":"chair"},
                                      {"mesh":0,"name":"chair","translation":[5,0,0]}])");
  document["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = import(document).scene;
  ASSERT_EQ(scene.objects.size(), 2U);
  EXPECT_EQ(scene.objects[0].name, "chair");
  EXPECT_EQ(scene.objects[1].name, "chair.2");
  EXPECT_EQ(scene.mesh.triangles.size(), 4U);
  EXPECT_EQ(scene.mesh.object.back(), 1U);
}

TEST_F(ImportGltf, BaseColourIsLinearReflectance) {
  const Scene scene = import(with_material(json::parse(
                                 R"({"name":"red","doubleSided":true,
          "pbrMetallicRoughness":{"baseColorFactor":[0.8,0.25,0.125,1],"metallicFactor":1}})")))
                          .scene;
  EXPECT_EQ(scene.materials.at(0).name, "red");
  EXPECT_EQ(scene.materials[0].reflectance, Rgb(0.8F, 0.25F, 0.125F));
  EXPECT_TRUE(scene.materials[0].two_sided);
  EXPECT_EQ(scene.mesh.two_sided[0], 1);
}

TEST_F(ImportGltf, SidesCanBeForced) {
  ImportConfig config;
  config.sides = Sides::kOne;
  const json document = with_material({{"doubleSided", true}});
  EXPECT_EQ(import(document, config).scene.mesh.two_sided[0], 0);
  config.sides = Sides::kTwo;
  EXPECT_EQ(import(gltf::square(), config).scene.mesh.two_sided[0], 1);
}

TEST_F(ImportGltf, WhiteIsClampedWithAWarningThatNamesTheMaterial) {
  const auto [scene, report] = import(with_material({{"name", "snow"}}));
  EXPECT_EQ(scene.materials.at(0).reflectance, Rgb(kMaxReflectance));
  EXPECT_THAT(report.warnings, Contains(HasSubstr("'snow'")));
}

TEST_F(ImportGltf, EmissiveStrengthMultipliesWhateverTheOrderOfMaterials) {
  json document = gltf::square();
  document["materials"] = json::parse(R"([
      {"name":"unused","emissiveFactor":[1,1,1],
       "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":99}}},
      {"name":"lamp","pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]},
       "emissiveFactor":[1,0.5,0.25],
       "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":40}}},
      {"name":"dim","emissiveFactor":[0.5,0.5,0.5],
       "pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]}}])");
  json second = document["meshes"][0];
  document["meshes"][0]["primitives"][0]["material"] = 2;
  second["primitives"][0]["material"] = 1;
  document["meshes"].push_back(second);
  document["nodes"].push_back({{"mesh", 1}, {"name", "bulb"}, {"translation", {0, 0, 3}}});
  document["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = import(document).scene;
  ASSERT_EQ(scene.materials.size(), 2U);
  expect_near(scene.material_of(0).emission, Rgb(0.5F));
  expect_near(scene.material_of(2).emission, Rgb(40, 20, 10));
  ASSERT_EQ(scene.lights.size(), 2U);
  EXPECT_EQ(scene.lights[1].type, LightType::kEmitter);
  EXPECT_EQ(scene.lights[1].name, "bulb");
  EXPECT_EQ(scene.lights[1].object, 1U);
}

TEST_F(ImportGltf, PointLightIsWattsPerSteradianWhereItsNodeIs) {
  const json document =
      with_light(json::parse(R"({"type":"point","color":[1,0.5,0],"intensity":30})"));
  const Scene scene = import(document).scene;
  ASSERT_EQ(scene.lights.size(), 1U);
  const Light& light = scene.lights[0];
  EXPECT_EQ(light.type, LightType::kPoint);
  EXPECT_EQ(light.name, "lamp");
  expect_near(light.position, {1, 2, 3});
  expect_near(light.power(), Rgb(30, 15, 0));
  ImportConfig config;
  config.photometric_lights = true;
  expect_near(import(document, config).scene.lights[0].power(), Rgb(30, 15, 0) / 683.0F);
}

TEST_F(ImportGltf, SpotLightHasHalfAnglesAndShinesAlongMinusZ) {
  const Scene scene = import(with_light(json::parse(
                                 R"({"type":"spot","intensity":5,
                     "spot":{"innerConeAngle":0.2,"outerConeAngle":0.5}})")))
                          .scene;
  const Light& light = scene.lights.at(0);
  EXPECT_EQ(light.type, LightType::kSpot);
  EXPECT_NEAR(light.inner_deg, 0.2 * 180 / std::numbers::pi, 1e-4);
  EXPECT_NEAR(light.outer_deg, 0.5 * 180 / std::numbers::pi, 1e-4);
  expect_near(light.direction, {0, -1, 0});
}

TEST_F(ImportGltf, InstancedLightsShineFromEveryNode) {
  json document = with_light(json::parse(R"({"type":"directional","intensity":2})"));
  document["nodes"].push_back(document["nodes"][1]);
  document["nodes"][2]["rotation"] = {0, 0, 0, 1};
  document["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = import(document).scene;
  ASSERT_EQ(scene.lights.size(), 2U);
  EXPECT_EQ(scene.lights[1].name, "lamp.2");
  expect_near(scene.lights[0].direction, {0, -1, 0});
  expect_near(scene.lights[1].direction, {0, 0, -1});
}

TEST_F(ImportGltf, CameraKeepsItsVerticalFieldOfView) {
  json document = with_node({{"camera", 0}, {"name", "view"}});
  document["cameras"] = json::parse(
      R"([{"type":"perspective","perspective":{"yfov":0.7,"aspectRatio":2,"znear":0.1}}])");
  const Scene scene = import(document).scene;
  ASSERT_EQ(scene.cameras.size(), 1U);
  const Camera& camera = scene.cameras[0];
  EXPECT_EQ(camera.name, "view");
  EXPECT_NEAR(camera.vfov_deg, 0.7 * 180 / std::numbers::pi, 1e-4);
  expect_near(camera.eye, {1, 2, 3});
  expect_near(normalized(camera.target - camera.eye), {0, -1, 0});
  expect_near(camera.up, {0, 0, -1});
}

/// A 2 × 2 picture: red, green above blue, white.
std::vector<std::uint8_t> four_colours() {
  return {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
}

json textured(const json& image) {
  json document = gltf::square();
  document["images"] = json::array({image});
  document["textures"] = json::parse(R"([{"source":0}])");
  document["materials"] = json::parse(
      R"([{"name":"picture","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])");
  document["meshes"][0]["primitives"][0]["material"] = 0;
  return document;
}

/// The square's corner (0, 0) shows the picture's lower left, blue; its (1, 1) the upper right,
/// green.
void expect_picture_upright(const Scene& scene) {
  ASSERT_EQ(scene.textures.size(), 1U);
  const auto at = [&](Vec2f point) {
    // Triangle 0 is (0,0) (1,0) (1,1); triangle 1 is (0,0) (1,1) (0,1).
    return point.y <= point.x ? scene.reflectance(0, point.x - point.y, point.y)
                              : scene.reflectance(1, point.x, point.y - point.x);
  };
  expect_near(at({0.25F, 0.25F}), Rgb(0, 0, 0.99F), 1e-5F);
  expect_near(at({0.75F, 0.75F}), Rgb(0, 0.99F, 0), 1e-5F);
  expect_near(at({0.25F, 0.75F}), Rgb(0.99F, 0, 0), 1e-5F);
  expect_near(at({0.75F, 0.25F}), Rgb(0.99F), 1e-5F);
}

TEST_F(ImportGltf, TextureBesideTheSceneIsUpright) {
  write_png(folder_ / "four colours.png", four_colours(), 2, 2);
  const auto [scene, report] = import(textured({{"uri", "four%20colours.png"}}));
  expect_picture_upright(scene);
  EXPECT_THAT(report.warnings, IsEmpty());
}

TEST_F(ImportGltf, EmbeddedTextureIsUpright) {
  write_png(folder_ / "picture.png", four_colours(), 2, 2);
  const std::string png = read_file(folder_ / "picture.png");
  expect_picture_upright(
      import(textured({{"uri", "data:image/png;base64," + gltf::base64(png)}})).scene);
}

TEST_F(ImportGltf, TextureTransformIsScaleThenRotationThenOffset) {
  write_png(folder_ / "picture.png", four_colours(), 2, 2);
  json document = textured({{"uri", "picture.png"}});
  json& texture = document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  const auto uv_at_corner = [&](double u, double v, double rotation) {
    // Counter-clockwise as the image is seen, v downwards.
    const double c = std::cos(rotation), s = std::sin(rotation);
    const double x = 0.5 * u, y = 2 * v;
    return Vec2f{static_cast<float>(c * x + s * y + 0.25),
                 static_cast<float>(-s * x + c * y + 0.5)};
  };
  for (const double rotation : {0.0, 0.3, 2.0}) {
    texture["extensions"]["KHR_texture_transform"] = {
        {"offset", {0.25, 0.5}}, {"scale", {0.5, 2}}, {"rotation", rotation}};
    const Scene scene = import(document).scene;
    ASSERT_EQ(scene.texcoords.size(), 4U);
    const double corners[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec2f expected = uv_at_corner(corners[i][0], corners[i][1], rotation);
      EXPECT_NEAR(scene.texcoords[i].x, expected.x, 1e-5F);
      EXPECT_NEAR(scene.texcoords[i].y, expected.y, 1e-5F);
    }
  }
}

TEST_F(ImportGltf, MissingTextureIsAWarningThatNamesIt) {
  const auto [scene, report] = import(textured({{"uri", "nowhere.png"}}));
  EXPECT_EQ(scene.materials.at(0).texture, kNone);
  EXPECT_THAT(report.warnings,
              Contains(::testing::AllOf(HasSubstr("nowhere.png"), HasSubstr("'picture'"))));
}

TEST_F(ImportGltf, TextureOutsideOfTheFolderIsNotRead) {
  write_png(folder_ / "outside.png", four_colours(), 2, 2);
  std::filesystem::create_directory(folder_ / "inner");
  write_file(folder_ / "inner/scene.gltf", textured({{"uri", "../outside.png"}}).dump());
  const auto [scene, report] = import_scene(folder_ / "inner/scene.gltf");
  EXPECT_THAT(scene.textures, IsEmpty());
  EXPECT_THAT(report.warnings, Contains(HasSubstr("'picture'")));
}

TEST_F(ImportGltf, LinesAndPointsAreCounted) {
  json document = gltf::square();
  json points = document["meshes"][0]["primitives"][0];
  points["mode"] = 0;
  points.erase("indices");
  document["meshes"][0]["primitives"].push_back(points);
  const auto [scene, report] = import(document);
  EXPECT_EQ(report.points_and_lines, 4U);
  EXPECT_EQ(scene.mesh.triangles.size(), 2U);
}

TEST_F(ImportGltf, MeshWithoutNormalsBesideOthersIsFlat) {
  json document = gltf::square();
  json with_normals = document["meshes"][0];
  with_normals["primitives"][0]["attributes"]["NORMAL"] = 1;  // the positions: odd, but normals
  document["meshes"].push_back(with_normals);
  document["nodes"].push_back({{"mesh", 1}, {"translation", {0, 0, 2}}});
  document["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = import(document).scene;
  ASSERT_EQ(scene.shading_normals.size(), scene.mesh.positions.size());
  EXPECT_EQ(scene.mesh.positions.size(), 6U + 4U);
  for (std::size_t v = 0; v < 6; ++v) expect_near(scene.shading_normals[v], {0, 0, 1});
  // A normal of no length is the triangle's.
  expect_near(scene.shading_normals[6], {0, 0, 1});
  expect_near(scene.shading_normals[7], {1, 0, 0});
}

}  // namespace
}  // namespace relumbre
