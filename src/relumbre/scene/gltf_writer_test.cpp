#include "relumbre/scene/gltf_writer.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/gltf_output.h"
#include "relumbre/scene/import.h"
#include "relumbre/scene/scene_builder.h"

namespace relumbre {
namespace {

using Json = nlohmann::json;

std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, 4);
  return word;
}

/// A .glb taken apart by the letter of the specification.
struct Glb {
  Json json;
  std::string bin;
};
Glb take_apart(const std::string& bytes) {
  Glb glb;
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word_at(bytes, 4), 2U);
  EXPECT_EQ(word_at(bytes, 8), bytes.size());
  const std::size_t text = word_at(bytes, 12);
  EXPECT_EQ(text % 4, 0U);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  glb.json = Json::parse(bytes.substr(20, text));
  const std::size_t bin = word_at(bytes, 20 + text);
  EXPECT_EQ(bin % 4, 0U);
  EXPECT_EQ(bytes.substr(24 + text, 4), std::string("BIN\0", 4));
  glb.bin = bytes.substr(28 + text);
  EXPECT_EQ(glb.bin.size(), bin);
  return glb;
}

std::size_t element_bytes(const Json& accessor) {
  const std::string type = accessor["type"];
  return 4 * (type == "SCALAR" ? 1U : type == "VEC2" ? 2U : 3U);
}

void expect_valid_accessors(const Glb& glb) {
  EXPECT_EQ(glb.json["buffers"][0]["byteLength"], glb.bin.size());
  for (const Json& view : glb.json["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0U);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(),
              glb.bin.size());
  }
  for (const Json& accessor : glb.json["accessors"]) {
    const Json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    EXPECT_GT(accessor["count"], 0U);
    EXPECT_EQ(accessor["count"].get<std::size_t>() * element_bytes(accessor), view["byteLength"]);
  }
}

template <class T>
std::vector<T> values(const Glb& glb, const Json& index) {
  const Json& accessor = glb.json["accessors"][index.get<std::size_t>()];
  const Json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  std::vector<T> read(view["byteLength"].get<std::size_t>() / sizeof(T));
  std::memcpy(read.data(), glb.bin.data() + view["byteOffset"].get<std::size_t>(),
              read.size() * sizeof(T));
  return read;
}

void expect_valid_primitive(const Glb& glb, const Json& primitive) {
  const Json& attributes = primitive["attributes"];
  const auto positions = values<Vec3f>(glb, attributes["POSITION"]);
  const Json& accessor = glb.json["accessors"][attributes["POSITION"].get<std::size_t>()];
  for (std::size_t c = 0; c < 3; ++c) {
    const auto by_axis = [c](const Vec3f& a, const Vec3f& b) { return a[c] < b[c]; };
    const auto [low, high] = std::minmax_element(positions.begin(), positions.end(), by_axis);
    EXPECT_EQ(accessor["min"][c].get<float>(), (*low)[c]);
    EXPECT_EQ(accessor["max"][c].get<float>(), (*high)[c]);
  }
  for (const auto& [name, attribute] : attributes.items())
    EXPECT_EQ(glb.json["accessors"][attribute.get<std::size_t>()]["count"], positions.size());
  const auto indices = values<std::uint32_t>(glb, primitive["indices"]);
  EXPECT_EQ(indices.size() % 3, 0U);
  for (const std::uint32_t i : indices) EXPECT_LT(i, positions.size());
  EXPECT_LT(primitive["material"].get<std::size_t>(), glb.json["materials"].size());
}

class GltfWriter : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
  Glb written(const Scene& scene) const {
    write_gltf(folder / "scene.glb", scene);
    return take_apart(read_file(folder / "scene.glb"));
  }
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) /
      ("relumbre_gltf_" +
       std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
};

/// Two quads of one object in two materials, one glowing strongly, one textured and two-sided.
Scene small_scene() {
  SceneBuilder builder;
  Material cloth;
  cloth.name = "cloth";
  cloth.reflectance = {0.1F, 0.2F, 0.3F};
  cloth.two_sided = true;
  cloth.texture = 0;
  const auto first = builder.add_material(cloth);
  const auto second = builder.add_glowing("lamp \"glow\" \xC3\xA9", {3, 12, 6});
  builder.begin_object("empty");
  builder.begin_object("thing");
  builder.use(first);
  builder.quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  builder.use(second);
  builder.quad({0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1});
  Scene scene = std::move(builder).finish();
  for (const Vec3f& p : scene.mesh.positions) scene.texcoords.push_back({p.x, 1 - p.y});
  for (const Vec3f& p : scene.mesh.positions) scene.colors.push_back(p);
  scene.textures.push_back({"checks", 2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 10, 20, 30}});
  return scene;
}

std::vector<Light> one_of_each_light() {
  std::vector<Light> lights(5);
  lights[0].name = "bulb";
  lights[0].type = LightType::kPoint;
  lights[0].position = {1, 2, 3};
  lights[0].color = {1, 0.5F, 0.25F};
  lights[0].intensity = 40;
  lights[1].name = "spot";
  lights[1].type = LightType::kSpot;
  lights[1].position = {0, 2, 0};
  lights[1].direction = normalized(Vec3f(1, -2, 0.5F));
  lights[1].inner_deg = 20;
  lights[1].outer_deg = 35;
  lights[1].intensity = 7;
  lights[2].name = "sun";
  lights[2].type = LightType::kDirectional;
  lights[2].direction = {0, -1, 0};
  lights[2].intensity = 900;
  lights[3].name = "quad";
  lights[3].type = LightType::kQuad;
  lights[4].name = "off";
  lights[4].type = LightType::kPoint;
  lights[4].on = false;
  return lights;
}

TEST_F(GltfWriter, EveryBuiltinSceneIsAValidGlb) {
  for (const BuiltinScene& builtin : builtin_scenes()) {
    const Scene scene = make_builtin_scene(builtin.name);
    const Glb glb = written(scene);
    EXPECT_EQ(glb.json["asset"]["version"], "2.0");
    expect_valid_accessors(glb);
    std::size_t triangles = 0;
    for (const Json& mesh : glb.json["meshes"])
      for (const Json& primitive : mesh["primitives"]) {
        expect_valid_primitive(glb, primitive);
        triangles += values<std::uint32_t>(glb, primitive["indices"]).size() / 3;
      }
    EXPECT_EQ(triangles, scene.mesh.triangles.size()) << builtin.name;
    EXPECT_EQ(glb.json["scenes"][0]["nodes"].size(), glb.json["nodes"].size());
  }
}

TEST_F(GltfWriter, MaterialsKeepTheirNumbersAndNames) {
  const Json json = written(small_scene()).json;
  const Json& cloth = json["materials"][0];
  EXPECT_EQ(cloth["name"], "cloth");
  EXPECT_EQ(cloth["doubleSided"], true);
  EXPECT_EQ(cloth["pbrMetallicRoughness"]["baseColorFactor"], Json({0.1, 0.2, 0.3, 1}));
  EXPECT_EQ(cloth["pbrMetallicRoughness"]["metallicFactor"], 0);
  EXPECT_EQ(cloth["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  EXPECT_FALSE(cloth.contains("emissiveFactor"));
  const Json& lamp = json["materials"][1];
  EXPECT_EQ(lamp["name"], "lamp \"glow\" \xC3\xA9");
  EXPECT_EQ(lamp["emissiveFactor"], Json({0.25, 1.0, 0.5}));
  EXPECT_EQ(lamp["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 12);
  EXPECT_EQ(json["extensionsUsed"], Json({"KHR_materials_emissive_strength"}));
}

TEST_F(GltfWriter, ObjectsBecomeMeshesWithAPrimitiveForEachMaterial) {
  const Json json = written(small_scene()).json;
  ASSERT_EQ(json["meshes"].size(), 1U);
  EXPECT_EQ(json["meshes"][0]["name"], "thing");
  EXPECT_EQ(json["nodes"][0]["name"], "thing");
  EXPECT_EQ(json["meshes"][0]["primitives"].size(), 2U);
}

TEST_F(GltfWriter, TexturesAreEmbeddedPng) {
  const Glb glb = written(small_scene());
  const Json& image = glb.json["images"][0];
  EXPECT_EQ(image["mimeType"], "image/png");
  const Json& view = glb.json["bufferViews"][image["bufferView"].get<std::size_t>()];
  EXPECT_EQ(glb.bin.substr(view["byteOffset"].get<std::size_t>() + 1, 3), "PNG");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1)
      << "only the scene is left";
}

TEST_F(GltfWriter, LightsKeepRadiometricNumbersAndOthersAreLeftOut) {
  Scene scene = small_scene();
  scene.lights = one_of_each_light();
  const Json json = written(scene).json;
  const Json& lights = json["extensions"]["KHR_lights_punctual"]["lights"];
  ASSERT_EQ(lights.size(), 4U);
  EXPECT_EQ(lights[0]["type"], "point");
  EXPECT_EQ(lights[0]["intensity"], 40);
  EXPECT_EQ(lights[0]["color"], Json({1.0, 0.5, 0.25}));
  EXPECT_EQ(lights[1]["type"], "spot");
  EXPECT_NEAR(lights[1]["spot"]["outerConeAngle"], 35 * std::numbers::pi / 180, 1e-6);
  EXPECT_LT(lights[1]["spot"]["innerConeAngle"], lights[1]["spot"]["outerConeAngle"]);
  EXPECT_EQ(lights[2]["type"], "directional");
  EXPECT_EQ(lights[3]["intensity"], 0);
}

TEST_F(GltfWriter, RoundTripKeepsTrianglesMaterialsAndObjects) {
  for (const char* extension : {"scene.glb", "scene.gltf"}) {
    const Scene scene = make_cornell_scene();
    write_gltf(folder / extension, scene);
    const Scene back = import_scene(folder / extension).scene;
    ASSERT_EQ(back.mesh.triangles.size(), 36U);
    ASSERT_EQ(back.objects.size(), scene.objects.size());
    ASSERT_EQ(back.lights.size(), 1U);
    EXPECT_EQ(back.lights[0].name, "lamp");
    for (std::uint32_t t = 0; t < 36; ++t) {
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(back.mesh.corner(t, i), scene.mesh.corner(t, i));
      EXPECT_EQ(back.objects[back.mesh.object[t]].name, scene.objects[scene.mesh.object[t]].name);
      EXPECT_EQ(back.material_of(t).name, scene.material_of(t).name);
      EXPECT_EQ(back.material_of(t).reflectance, scene.material_of(t).reflectance);
      EXPECT_NEAR(length(back.material_of(t).emission - scene.material_of(t).emission), 0, 1e-4);
      EXPECT_EQ(back.material_of(t).two_sided, scene.material_of(t).two_sided);
    }
  }
}

TEST_F(GltfWriter, RoundTripKeepsTheRoom) {
  const Scene scene = make_room_scene();
  write_gltf(folder / "room.glb", scene);
  const ImportResult back = import_scene(folder / "room.glb");
  EXPECT_EQ(back.scene.mesh.triangles.size(), scene.mesh.triangles.size());
  EXPECT_EQ(back.scene.objects.size(), scene.objects.size());
  ASSERT_EQ(back.scene.lights.size(), scene.lights.size());
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    EXPECT_EQ(back.scene.lights[i].name, scene.lights[i].name);
  EXPECT_TRUE(back.report.warnings.empty());
  EXPECT_EQ(back.report.degenerate + back.report.duplicate + back.report.non_finite, 0U);
  EXPECT_EQ(back.scene.shading_normals.size(), back.scene.mesh.positions.size());
}

TEST_F(GltfWriter, RoundTripKeepsCamerasInEveryDirection) {
  Scene scene = small_scene();
  const std::vector<Vec3f> targets{{0, 0, -1}, {0, 0, 1},  {1, 0, 0}, {-1, 0.2F, 0},
                                   {0, 5, 0},  {0, -5, 0}, {1, 1, 1}, {-0.3F, -2, 0.1F}};
  for (const Vec3f& target : targets)
    scene.cameras.push_back({"camera " + std::to_string(scene.cameras.size()),
                             {1, 2, 3},
                             Vec3f(1, 2, 3) + target,
                             {0, 1, 0},
                             40});
  write_gltf(folder / "scene.glb", scene);
  const Scene back = import_scene(folder / "scene.glb").scene;
  ASSERT_EQ(back.cameras.size(), targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Camera& camera = back.cameras[i];
    EXPECT_EQ(camera.name, scene.cameras[i].name);
    EXPECT_NEAR(camera.vfov_deg, 40, 1e-4);
    EXPECT_NEAR(length(camera.eye - Vec3f(1, 2, 3)), 0, 1e-6);
    EXPECT_NEAR(length(normalized(camera.target - camera.eye) - normalized(targets[i])), 0, 1e-5)
        << i;
  }
}

TEST_F(GltfWriter, RoundTripKeepsPunctualLightsAndTextures) {
  Scene scene = small_scene();
  scene.lights = one_of_each_light();
  write_gltf(folder / "scene.gltf", scene);
  const Scene back = import_scene(folder / "scene.gltf").scene;
  const auto find = [&](const std::string& name) {
    const auto light = std::find_if(back.lights.begin(), back.lights.end(),
                                    [&](const Light& l) { return l.name == name; });
    return light == back.lights.end() ? Light{} : *light;
  };
  EXPECT_NEAR(length(find("bulb").power() - Rgb(40, 20, 10)), 0, 1e-4);
  EXPECT_NEAR(length(find("bulb").position - Vec3f(1, 2, 3)), 0, 1e-6);
  EXPECT_EQ(find("spot").type, LightType::kSpot);
  EXPECT_NEAR(find("spot").outer_deg, 35, 1e-3);
  EXPECT_NEAR(find("spot").inner_deg, 20, 1e-3);
  EXPECT_NEAR(length(find("spot").direction - scene.lights[1].direction), 0, 1e-5);
  EXPECT_NEAR(length(find("sun").direction - Vec3f(0, -1, 0)), 0, 1e-5);
  EXPECT_EQ(find("off").power(), Rgb(0));
  ASSERT_EQ(back.textures.size(), 1U);
  EXPECT_EQ(back.textures[0].rgb, scene.textures[0].rgb);
}

TEST_F(GltfWriter, ColoredMeshShowsItsColoursUnlit) {
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Index3> triangles{{0, 1, 2}};
  const std::vector<Rgb> colors{
      {0.25F, 0.5F, 4}, {-1, 0, 1}, {std::numeric_limits<float>::quiet_NaN(), 1, 0.1F}};
  write_colored_mesh(folder / "b.glb", positions, triangles, colors);
  const Glb glb = take_apart(read_file(folder / "b.glb"));
  expect_valid_accessors(glb);
  const Json& primitive = glb.json["meshes"][0]["primitives"][0];
  expect_valid_primitive(glb, primitive);
  EXPECT_EQ(values<Rgb>(glb, primitive["attributes"]["COLOR_0"]),
            (std::vector<Rgb>{{0.25F, 0.5F, 1}, {0, 0, 1}, {0, 1, 0.1F}}));
  EXPECT_TRUE(glb.json["materials"][0]["extensions"].contains("KHR_materials_unlit"));
}

TEST_F(GltfWriter, ColoredMeshRefusesShapesThatDisagree) {
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Rgb> colors(3);
  const std::vector<Index3> good{{0, 1, 2}}, bad{{0, 1, 3}};
  EXPECT_THROW(write_colored_mesh(folder / "b.glb", positions, bad, colors), ShapeError);
  EXPECT_THROW(write_colored_mesh(folder / "b.glb", positions, good, std::span(colors).first(2)),
               ShapeError);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(GltfWriter, RefusesWhatItCannotWriteAndLeavesNothing) {
  Scene scene = small_scene();
  EXPECT_THROW(write_gltf(folder / "scene.obj", scene), ValueError);
  EXPECT_THROW(write_gltf(folder / "missing" / "scene.glb", scene), FileError);
  Scene infinite = scene;
  infinite.mesh.positions[1].y = std::numeric_limits<float>::infinity();
  EXPECT_THROW(write_gltf(folder / "scene.glb", infinite), ValueError);
  Scene out_of_range = scene;
  out_of_range.mesh.triangles[0][2] = 1000;
  EXPECT_THROW(write_gltf(folder / "scene.glb", out_of_range), ValueError);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(ShortDecimal, ReadsBackAsTheSameFloat) {
  EXPECT_EQ(short_decimal(0.1F), 0.1);
  for (const float value : {1.0F / 3, 1e-30F, 3.4e38F, -0.7F, 16777217.0F, 0.0F})
    EXPECT_EQ(static_cast<float>(short_decimal(value)), value);
}

}  // namespace
}  // namespace relumbre
