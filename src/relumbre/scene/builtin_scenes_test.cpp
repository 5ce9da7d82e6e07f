#include "relumbre/scene/builtin_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "relumbre/base/box.h"
#include "relumbre/base/error.h"
#include "relumbre/scene/builtin_room.h"
#include "relumbre/scene/mesh_checks.h"

namespace relumbre {
namespace {

class EveryBuiltinScene : public ::testing::TestWithParam<std::string> {
 protected:
  const Scene scene = make_builtin_scene(GetParam());
};

TEST_P(EveryBuiltinScene, HasConsistentArrays) {
  const TriangleMesh& mesh = scene.mesh;
  ASSERT_EQ(mesh.material.size(), mesh.triangles.size());
  ASSERT_EQ(mesh.object.size(), mesh.triangles.size());
  ASSERT_EQ(mesh.two_sided.size(), mesh.triangles.size());
  ASSERT_EQ(scene.shading_normals.size(), mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) ASSERT_LT(v, mesh.positions.size());
    ASSERT_LT(mesh.material[t], scene.materials.size());
    ASSERT_LT(mesh.object[t], scene.objects.size());
    ASSERT_EQ(mesh.two_sided[t] == 1, scene.material_of(static_cast<std::uint32_t>(t)).two_sided);
  }
}

TEST_P(EveryBuiltinScene, HasNoDegenerateTriangle) {
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t)
    EXPECT_GT(length(scene.mesh.scaled_normal(t)), 1e-9F) << "triangle " << t;
}

TEST_P(EveryBuiltinScene, ReflectsLessThanItReceives) {
  for (const Material& material : scene.materials)
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_GE(material.reflectance[c], 0) << material.name;
      EXPECT_LE(material.reflectance[c], kMaxReflectance) << material.name;
      EXPECT_GE(material.emission[c], 0) << material.name;
    }
}

TEST_P(EveryBuiltinScene, NamesAreThereAndObjectsAreUnique) {
  std::set<std::string> names;
  for (const Object& object : scene.objects) {
    EXPECT_FALSE(object.name.empty());
    EXPECT_TRUE(names.insert(object.name).second) << object.name;
  }
  for (const Material& material : scene.materials) EXPECT_FALSE(material.name.empty());
}

TEST_P(EveryBuiltinScene, HasOneLightForEveryObjectThatGlows) {
  std::set<std::uint32_t> glowing, lit;
  for (std::uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
    if (scene.material_of(t).emissive()) glowing.insert(scene.mesh.object[t]);
  for (const Light& light : scene.lights) {
    EXPECT_EQ(light.type, LightType::kEmitter);
    EXPECT_EQ(light.name, scene.objects[light.object].name);
    EXPECT_TRUE(light.on);
    EXPECT_TRUE(lit.insert(light.object).second);
  }
  EXPECT_FALSE(glowing.empty());
  EXPECT_EQ(glowing, lit);
}

TEST_P(EveryBuiltinScene, MainCameraSeesFrontsOnly) {
  ASSERT_FALSE(scene.cameras.empty());
  EXPECT_EQ(scene.cameras.front().name, "main");
  constexpr int kRays = 300;
  for (const Camera& camera : scene.cameras) {
    const Vec3d forward = normalized(Vec3d(camera.target - camera.eye));
    for (int i = 0; i < kRays; ++i) {
      const Vec3d direction = sphere_direction(i, kRays);
      if (dot(direction, forward) < 0.7) continue;
      const auto hit = brute_closest(scene.mesh, Vec3d(camera.eye), direction);
      if (hit && scene.mesh.two_sided[hit->triangle] == 0) {
        EXPECT_FALSE(hit->back) << "ray " << i;
      }
    }
  }
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const BuiltinScene& scene : builtin_scenes()) names.emplace_back(scene.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Builtin, EveryBuiltinScene, ::testing::ValuesIn(all_names()), test_name);

TEST(BuiltinScenes, AnUnknownNameIsAnErrorThatListsTheKnown) {
  try {
    make_builtin_scene("sponza");
    FAIL();
  } catch (const ValueError& error) {
    for (const char* word : {"sponza", "cornell", "room", "furnace-cube", "teapots"})
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word;
  }
}

TEST(Cornell, HasThePapers36Triangles) {
  const Scene scene = make_cornell_scene();
  EXPECT_EQ(scene.mesh.triangles.size(), 36U);
  for (const char* name : {"floor", "ceiling", "back wall", "red wall", "green wall", "lamp"})
    EXPECT_EQ(triangles_of(scene, name).size(), 2U) << name;
  for (const char* name : {"short block", "tall block"})
    EXPECT_EQ(triangles_of(scene, name).size(), 12U) << name;
}

/// The object that the camera sees at (x, y), each from -1 at the left and bottom to 1.
std::string seen(const Scene& scene, double x, double y) {
  const Camera& camera = scene.cameras.front();
  const Vec3d forward = normalized(Vec3d(camera.target - camera.eye));
  const Vec3d right = normalized(cross(forward, Vec3d(camera.up)));
  const double half = std::tan(camera.vfov_deg * std::numbers::pi / 360);
  const Vec3d direction = forward + (right * x + cross(right, forward) * y) * half;
  const auto hit = brute_closest(scene.mesh, Vec3d(camera.eye), direction);
  return hit ? scene.objects[scene.mesh.object[hit->triangle]].name : "nothing";
}

TEST(Cornell, LooksAsInTheWellKnownPicture) {
  const Scene scene = make_cornell_scene();
  EXPECT_EQ(seen(scene, -0.8, 0.1), "red wall");
  EXPECT_EQ(seen(scene, 0.8, 0.1), "green wall");
  EXPECT_EQ(seen(scene, 0.0, 0.72), "lamp");
  EXPECT_EQ(seen(scene, -0.2, -0.3), "tall block");
  EXPECT_EQ(seen(scene, 0.25, -0.6), "short block");
  EXPECT_EQ(seen(scene, 0.0, -0.93), "floor");
  EXPECT_EQ(seen(scene, 0.1, 0.3), "back wall");
  EXPECT_EQ(seen(scene, 0.0, 0.9), "ceiling");
}

TEST(Cornell, BlocksAreClosedAndOfTheMeasuredVolume) {
  const Scene scene = make_cornell_scene();
  for (const auto& [name, litres] : {std::pair{"short block", 4.5594}, {"tall block", 9.1167}}) {
    TriangleMesh block;
    block.positions = scene.mesh.positions;
    for (const std::size_t t : triangles_of(scene, name))
      block.triangles.push_back(scene.mesh.triangles[t]);
    EXPECT_EQ(unmatched_edges(block), 0U) << name;
    EXPECT_NEAR(signed_volume(block), litres * 1e-3, 1e-6) << name;
  }
}

TEST(FurnaceCube, IsClosedAndFacesInward) {
  const Scene scene = make_furnace_cube_scene();
  EXPECT_EQ(scene.mesh.triangles.size(), 12U);
  EXPECT_EQ(unmatched_edges(scene.mesh), 0U);
  EXPECT_DOUBLE_EQ(signed_volume(scene.mesh), -1);
  for (const Material& material : scene.materials) {
    EXPECT_EQ(material.reflectance, Rgb(0.5F));
    EXPECT_EQ(material.emission, Rgb(1));
  }
}

TEST(Room, IsAboutAsFineAsADesignersModel) {
  const std::size_t triangles = make_room_scene().mesh.triangles.size();
  EXPECT_GE(triangles, 5000U);
  EXPECT_LE(triangles, 25000U);
}

TEST(Room, HasFourNamedLamps) {
  std::set<std::string> names;
  for (const Light& light : make_room_scene().lights) names.insert(light.name);
  EXPECT_EQ(names,
            (std::set<std::string>{"ceiling panel", "desk lamp", "floor lamp", "pendant lamp"}));
}

TEST(Room, CamerasStandInside) {
  const Scene scene = make_room_scene();
  ASSERT_EQ(scene.cameras.size(), 2U);
  EXPECT_EQ(scene.cameras[1].name, "corner");
  for (const Camera& camera : scene.cameras) {
    EXPECT_TRUE(camera.eye.x > 0 && camera.eye.x < kRoomWidth);
    EXPECT_TRUE(camera.eye.y > 0 && camera.eye.y < kRoomHeight);
    EXPECT_TRUE(camera.eye.z > 0 && camera.eye.z < kRoomDepth);
  }
}

TEST(Room, IsOpenAtBothWindows) {
  const Scene scene = make_room_scene();
  for (const Rect& window : kWindows) {
    const Vec3d pane{kRoomWidth, window.v0 + 0.6, window.u0 + 0.3};
    const Vec3d inside{3.3, 1.5, pane.z};
    EXPECT_FALSE(brute_closest(scene.mesh, inside, pane - inside));
  }
}

TEST(Room, LightLeavesThroughTheWindowsOnly) {
  const Scene scene = make_room_scene();
  const Vec3d origin{2.6, 1.9, 2.0};
  constexpr int kRays = 1200;
  int left = 0;
  for (int i = 0; i < kRays; ++i) {
    const Vec3d d = sphere_direction(i, kRays);
    if (const auto hit = brute_closest(scene.mesh, origin, d)) {
      EXPECT_FALSE(hit->back && scene.mesh.two_sided[hit->triangle] == 0) << "ray " << i;
      continue;
    }
    ++left;
    const Vec3d at = origin + d * ((kRoomWidth - origin.x) / d.x);
    EXPECT_GT(d.x, 0);
    EXPECT_TRUE(std::any_of(
        kWindows.begin(), kWindows.end(),
        [&](const Rect& w) { return at.z > w.u0 && at.z < w.u1 && at.y > w.v0 && at.y < w.v1; }))
        << "ray " << i;
  }
  EXPECT_GT(left, 20);
}

TEST(Room, LampsHaveComparablePower) {
  const Scene scene = make_room_scene();
  for (const Light& light : scene.lights) {
    double watts = 0;
    for (const std::size_t t : triangles_of(scene, light.name))
      watts += length(scene.mesh.scaled_normal(t)) / 2 *
               luminance(scene.material_of(static_cast<std::uint32_t>(t)).emission);
    EXPECT_GT(watts, 5) << light.name;
    EXPECT_LT(watts, 25) << light.name;
  }
}

TEST(Teapots, StandWhereThePaperPutsThem) {
  const Scene scene = make_teapots_scene();
  const std::array<Vec3d, 5> positions{
      {{-1.1, -0.5, -4.5}, {-0.5, -0.5, -5}, {0.2, -0.5, -5.5}, {1, -0.5, -6}, {1.8, -0.5, -6.5}}};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto triangles = triangles_of(scene, "teapot " + std::to_string(i + 1));
    EXPECT_GT(triangles.size(), 6000U);
    Box box;
    for (const std::size_t t : triangles)
      for (const std::uint32_t corner : scene.mesh.triangles[t])
        box.extend(scene.mesh.positions[corner]);
    // A body of radius 0.5 about the position, and 0.375 below it the foot.
    EXPECT_NEAR((box.lower.z + box.upper.z) / 2, positions[i].z, 1e-3);
    EXPECT_NEAR(box.upper.z - box.lower.z, 1, 0.01);
    EXPECT_NEAR(box.lower.y, positions[i].y - 0.375, 1e-3);
    EXPECT_NEAR(box.lower.x, positions[i].x - 0.75, 0.01);
  }
}

TEST(Teapots, ThePapersCameraSeesAllFiveWithinItsRange) {
  const Scene scene = make_teapots_scene();
  ASSERT_EQ(scene.cameras.size(), 1U);
  const Camera& camera = scene.cameras.front();
  EXPECT_EQ(camera.vfov_deg, 45);
  EXPECT_EQ(camera.eye, (Vec3f{0, 0, 0}));
  EXPECT_EQ(normalized(camera.target - camera.eye), (Vec3f{0, 0, -1}));
  std::set<std::string> names;
  for (double x = -1.7; x <= 1.7; x += 0.05)
    for (double y = -1; y <= 1; y += 0.05) names.insert(seen(scene, x, y));
  for (int i = 1; i <= 5; ++i) EXPECT_TRUE(names.contains("teapot " + std::to_string(i))) << i;
  EXPECT_FALSE(names.contains("nothing"));
  for (const Vec3f& p : scene.mesh.positions) EXPECT_GT(p.z, -15);
}

}  // namespace
}  // namespace relumbre
