#include "relumbre/scene/lights_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/image/exr.h"

namespace relumbre {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

/// Two emitters and a point light.
Scene lit_scene() {
  Scene scene;
  for (const char* name : {"ceiling", "desk", "bulb"}) {
    Light light;
    light.name = name;
    light.type = name == std::string("bulb") ? LightType::kPoint : LightType::kEmitter;
    light.intensity = 2;
    scene.lights.push_back(light);
  }
  return scene;
}

std::vector<Light> parse(const std::string& text) {
  return parse_lights(text, "lights.json", ".", lit_scene());
}

std::vector<std::string> names(const std::vector<Light>& lights) {
  std::vector<std::string> result;
  for (const Light& light : lights) result.push_back(light.name);
  return result;
}

TEST(LightsJson, ReadsEveryKindWithoutAFile) {
  const std::vector<Light> lights = parse(R"([
    {"type":"point","name":"a","position":[1,2,3],"color":[1,0.5,0],"intensity":10},
    {"type":"spot","position":[0,3,0],"direction":[0,-2,0],"inner_deg":10,"outer_deg":30},
    {"type":"directional","direction":[3,0,-4],"on":false},
    {"type":"quad","corner":[0,0,0],"edge1":[0,0,1],"edge2":[1,0,0],"intensity":5}])");
  ASSERT_EQ(lights.size(), 4U);
  EXPECT_EQ(lights[0].type, LightType::kPoint);
  EXPECT_EQ(lights[0].position, Vec3f(1, 2, 3));
  EXPECT_EQ(lights[0].power(), Rgb(10, 5, 0));
  EXPECT_EQ(lights[1].name, "light 1");
  EXPECT_EQ(lights[1].direction, Vec3f(0, -1, 0));
  EXPECT_EQ(lights[1].inner_deg, 10);
  EXPECT_EQ(lights[1].outer_deg, 30);
  EXPECT_EQ(lights[2].direction, Vec3f(0.6F, 0, -0.8F));
  EXPECT_EQ(lights[2].power(), Rgb());
  EXPECT_EQ(lights[3].direction, Vec3f(0, 1, 0));
  EXPECT_EQ(lights[3].edge2, Vec3f(1, 0, 0));
}

TEST(LightsJson, TakesAnObjectWithAnArray) {
  EXPECT_EQ(parse(R"({"lights":[{"type":"point","position":[0,0,0]}]})").size(), 1U);
  EXPECT_EQ(parse("[]").size(), 0U);
  EXPECT_EQ(parse(R"({"lights":[]})").size(), 0U);
}

TEST(LightsJson, FilesAreFoundBesideTheJson) {
  const TemporaryFolder folder;
  write_file(folder / "lamp.ies", "TILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 50\n0 90\n0\n10 5\n");
  Image image = rgb_image(4, 2);
  image.set_rgb(3, Rgb(1, 2, 3));
  write_exr(folder / "sky.exr", image);
  write_file(folder / "lights.json",
             R"([{"type":"ies","file":"lamp.ies","position":[0,2,0],"rotation_deg":90},
                 {"type":"sky","file":"sky.exr","rotation_deg":45}])");
  const std::vector<Light> lights = read_lights(folder / "lights.json", {});
  ASSERT_EQ(lights.size(), 2U);
  EXPECT_EQ(lights[0].ies->peak(), 10);
  EXPECT_EQ(lights[0].direction, Vec3f(0, -1, 0));
  EXPECT_EQ(lights[0].rotation_deg, 90);
  EXPECT_EQ(lights[1].sky->rgb(3), Rgb(1, 2, 3));
}

TEST(LightsJson, SkyMustBeRadiance) {
  const TemporaryFolder folder;
  Image image = rgb_image(2, 1);
  image.set_rgb(0, Rgb(-1, 0, 0));
  write_exr(folder / "sky.exr", image);
  write_file(folder / "lights.json", R"([{"type":"sky","file":"sky.exr"}])");
  EXPECT_THAT([&] { read_lights(folder / "lights.json", {}); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("sky.exr"), HasSubstr("negative"))));
  write_file(folder / "lights.json", R"([{"type":"sky","file":"gone.exr"}])");
  EXPECT_THAT([&] { read_lights(folder / "lights.json", {}); },
              ThrowsMessage<FileError>(HasSubstr("gone.exr")));
}

TEST(LightsJson, SceneLightsAreMultipliedAndSwitched) {
  const std::vector<Light> lights = parse(
      R"([{"type":"scene","name":"desk","intensity":0.5,"color":[1,0.5,0]},
          {"type":"scene","name":"bulb","on":false}])");
  ASSERT_EQ(lights.size(), 2U);
  EXPECT_EQ(lights[0].type, LightType::kEmitter);
  EXPECT_EQ(lights[0].power(), Rgb(1, 0.5F, 0));
  EXPECT_EQ(lights[1].power(), Rgb());
}

TEST(LightsJson, AdjustedLightsReplaceTheScenes) {
  const Scene scene = lit_scene();
  const std::vector<Light> read = parse(
      R"([{"type":"point","name":"new","position":[0,0,0]},
          {"type":"scene","name":"desk","intensity":0}])");
  const std::vector<Light> all = combine_lights(scene.lights, read, true);
  EXPECT_THAT(names(all), ::testing::ElementsAre("ceiling", "desk", "bulb", "new"));
  EXPECT_EQ(all[1].intensity, 0);
  EXPECT_EQ(all[0].intensity, 2);
  EXPECT_THAT(names(combine_lights(scene.lights, read, false)),
              ::testing::ElementsAre("desk", "new"));
  EXPECT_THAT(names(combine_lights(scene.lights, {}, true)),
              ::testing::ElementsAre("ceiling", "desk", "bulb"));
  EXPECT_TRUE(combine_lights(scene.lights, {}, false).empty());
}

TEST(LightsJson, RefusesWithTheLightAndTheKey) {
  const auto refused = [](const std::string& text, const std::string& reason) {
    EXPECT_THAT([&] { parse(text); },
                ThrowsMessage<FileError>(
                    AllOf(HasSubstr("lights.json: "), HasSubstr(reason), Not(HasSubstr("\n")))))
        << text;
  };
  const auto point = [](const std::string& rest) {
    return R"([{"type":"point","name":"lamp","position":[0,0,0]},{"type":"point","name":"x")" +
           rest + "}]";
  };
  refused("", "JSON");
  refused("[1,\n2", "JSON");
  refused("3", "array");
  refused("[3]", "light 0");
  refused(R"({"light":[]})", "'light'");
  refused(R"({"lights":3})", "array");
  refused("[{}]", "light 0: key 'type' is missing");
  refused(R"([{"type":"laser"}])", "'type'");
  refused(R"([{"type":5}])", "'type'");
  refused(point(""), "light 1 'x': key 'position' is missing");
  refused(point(R"(,"position":[0,0])"), "'position'");
  refused(point(R"(,"position":[0,0,"1"])"), "'position'");
  refused(point(R"(,"position":[0,0,1e300])"), "'position'");
  refused(point(R"(,"position":[0,0,NaN])"), "JSON");
  refused(point(R"(,"position":[0,0,0],"intensity":-1)"), "'intensity'");
  refused(point(R"(,"position":[0,0,0],"intensity":null)"), "'intensity'");
  refused(point(R"(,"position":[0,0,0],"intensity":1e999)"), "");
  refused(point(R"(,"position":[0,0,0],"intensity":1e30,"color":[1e30,1,1])"), "'intensity'");
  refused(point(R"(,"position":[0,0,0],"color":[1,1,-1])"), "'color'");
  refused(point(R"(,"position":[0,0,0],"on":1)"), "'on'");
  refused(point(R"(,"position":[0,0,0],"colour":[1,1,1])"), "'colour'");
  refused(point(R"(,"position":[0,0,0],"direction":[0,0,1])"), "'direction'");
  refused(R"([{"type":"point","name":"a","position":[0,0,0]},
              {"type":"point","name":"a","position":[0,0,0]}])",
          "twice");
  refused(R"([{"type":"point","name":"desk","position":[0,0,0]}])", "'desk'");
  refused(R"([{"type":"scene","name":"sofa"}])", "'sofa'");
  refused(R"([{"type":"scene"}])", "'name'");
  refused(R"([{"type":"spot","position":[0,0,0],"direction":[0,0,0],"outer_deg":3}])",
          "'direction'");
  refused(R"([{"type":"spot","position":[0,0,0],"direction":[0,0,1]}])", "'outer_deg'");
  refused(R"([{"type":"spot","position":[0,0,0],"direction":[0,0,1],"outer_deg":91}])",
          "'outer_deg'");
  refused(
      R"([{"type":"spot","position":[0,0,0],"direction":[0,0,1],"outer_deg":9,"inner_deg":10}])",
      "'inner_deg'");
  refused(R"([{"type":"quad","corner":[0,0,0],"edge1":[1,0,0],"edge2":[2,0,0]}])", "'edge2'");
  refused(R"([{"type":"ies","position":[0,0,0],"file":""}])", "'file'");
}

TEST(LightsJson, MissingFilesAreNamed) {
  EXPECT_THAT([] { read_lights("/nowhere/lights.json", {}); },
              ThrowsMessage<FileError>(HasSubstr("/nowhere/lights.json")));
  EXPECT_THAT([] { parse(R"([{"type":"ies","position":[0,0,0],"file":"gone.ies"}])"); },
              ThrowsMessage<FileError>(HasSubstr("gone.ies")));
}

}  // namespace
}  // namespace relumbre
