#include "relumbre/scene/camera.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/scene/scene.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(CameraJson, SurvivesWritingAndReading) {
  const TemporaryFolder folder;
  const Camera camera{"left", {1, 2.5F, -3}, {0.1F, 0, 0}, {0, 0, 1}, 37.5F};
  write_camera(folder / "cam.json", camera);
  const Camera read = read_camera(folder / "cam.json");
  EXPECT_EQ(read.name, camera.name);
  EXPECT_EQ(read.eye, camera.eye);
  EXPECT_EQ(read.target, camera.target);
  EXPECT_EQ(read.up, camera.up);
  EXPECT_EQ(read.vfov_deg, camera.vfov_deg);
}

TEST(CameraJson, UpAndFieldOfViewHaveDefaults) {
  const Camera camera = parse_camera(R"({"eye":[0,0,5],"target":[0,0,0]})", "cam.json");
  EXPECT_EQ(camera.up, Vec3f(0, 1, 0));
  EXPECT_EQ(camera.vfov_deg, 45);
}

TEST(CameraJson, RefusesNamingTheKey) {
  const auto refused = [](const std::string& text, const std::string& key) {
    EXPECT_THAT([&] { parse_camera(text, "cam.json"); },
                ThrowsMessage<FileError>(HasSubstr("cam.json: " + key)))
        << text;
  };
  refused("", "not valid JSON");
  refused("[]", "is not a JSON object");
  refused(R"({"target":[0,0,0]})", "key 'eye'");
  refused(R"({"eye":[0,0,5]})", "key 'target'");
  refused(R"({"eye":[0,0],"target":[0,0,0]})", "key 'eye'");
  refused(R"({"eye":[0,0,5],"target":[0,0,5]})", "key 'target'");
  refused(R"({"eye":[0,0,5],"target":[0,0,0],"up":[0,0,2]})", "key 'up'");
  refused(R"({"eye":[0,0,5],"target":[0,0,0],"vfov_deg":180})", "key 'vfov_deg'");
  refused(R"({"eye":[0,0,5],"target":[0,0,0],"vfov_deg":"wide"})", "key 'vfov_deg'");
  refused(R"({"eye":[0,0,5],"target":[0,0,0],"fov":45})", "key 'fov'");
}

TEST(CameraJson, NumbersThatAreNotFiniteAreNotWritten) {
  const TemporaryFolder folder;
  Camera camera;
  camera.eye.x = std::nanf("");
  EXPECT_THROW(write_camera(folder / "cam.json", camera), ValueError);
  EXPECT_FALSE(std::filesystem::exists(folder / "cam.json"));
}

TEST(CameraJson, UnwritableFolderIsNamed) {
  EXPECT_THAT([] { write_camera("/nowhere/cam.json", {}); },
              ThrowsMessage<FileError>(HasSubstr("/nowhere/cam.json")));
}

void add_quad(Scene& scene, const Vec3f& corner, const Vec3f& e1, const Vec3f& e2) {
  TriangleMesh& mesh = scene.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3f& p : {corner, corner + e1, corner + e1 + e2, corner + e2}) {
    mesh.positions.push_back(p);
  }
  for (const Index3& t :
       {Index3{first, first + 1, first + 2}, Index3{first, first + 2, first + 3}}) {
    mesh.triangles.push_back(t);
    mesh.material.push_back(0);
    mesh.object.push_back(0);
    mesh.two_sided.push_back(0);
  }
}

constexpr Vec3f kSize{4, 2, 3};

/// The sides of a room of kSize, in the order -x, +x, -y, +y, -z, +z; some left out.
Scene room(std::initializer_list<int> without) {
  Scene scene;
  scene.materials.emplace_back();
  const Vec3f x{kSize.x, 0, 0}, y{0, kSize.y, 0}, z{0, 0, kSize.z};
  const Vec3f corners[] = {{}, x, {}, y, {}, z};
  const Vec3f edges[][2] = {{y, z}, {z, y}, {z, x}, {x, z}, {x, y}, {y, x}};
  for (int side = 0; side < 6; ++side) {
    if (std::ranges::find(without, side) == without.end()) {
      add_quad(scene, corners[side], edges[side][0], edges[side][1]);
    }
  }
  return scene;
}

/// Whether a square picture shows the point.
bool shows(const Camera& camera, const Vec3f& point) {
  const Vec3f forward = normalized(camera.target - camera.eye);
  const Vec3f right = normalized(cross(forward, camera.up)), up = cross(right, forward);
  const Vec3f to = point - camera.eye;
  const float depth = dot(to, forward);
  const float edge = std::tan(camera.vfov_deg / 2 * std::numbers::pi_v<float> / 180) * depth;
  return depth > 0 && std::abs(dot(to, right)) <= edge && std::abs(dot(to, up)) <= edge;
}

bool shows_all(const Camera& camera, const Scene& scene) {
  return std::ranges::all_of(scene.mesh.positions,
                             [&](const Vec3f& p) { return shows(camera, p); });
}

TEST(AutoCamera, TakesTheScenesOwn) {
  Scene scene = room({});
  scene.cameras.push_back({"own", {1, 1, 1}, {0, 0, 0}, {0, 1, 0}, 33});
  EXPECT_EQ(auto_camera(scene).name, "own");
}

TEST(AutoCamera, LooksInThroughTheOpenSide) {
  for (const int open : {0, 1, 4, 5}) {
    const Scene scene = room({open});
    const Camera camera = auto_camera(scene);
    Vec3f outwards;
    outwards[static_cast<std::size_t>(open) / 2] = open % 2 == 0 ? -1.0F : 1.0F;
    EXPECT_NEAR(dot(normalized(camera.eye - camera.target), outwards), 1, 1e-6) << open;
    EXPECT_TRUE(shows_all(camera, scene)) << open;
  }
}

TEST(AutoCamera, StandsInsideAClosedRoom) {
  Scene scene = room({});
  // A wardrobe in front of two corners' views.
  add_quad(scene, {0.9F, 0, 0}, {0, 2, 0}, {0, 0, 1});
  const Camera camera = auto_camera(scene);
  EXPECT_GT(camera.eye.x, 0);
  EXPECT_LT(camera.eye.x, kSize.x);
  EXPECT_GT(camera.eye.y, 0.5F);
  EXPECT_LT(camera.eye.y, kSize.y);
  EXPECT_GT(camera.eye.z, 0);
  EXPECT_LT(camera.eye.z, kSize.z);
}

TEST(AutoCamera, ShowsAllOfAnythingElse) {
  for (const Scene& scene : {room({3}), room({0, 1}), room({0, 1, 4, 5}), room({0, 1, 3, 4, 5})}) {
    const Camera camera = auto_camera(scene);
    EXPECT_TRUE(shows_all(camera, scene));
    EXPECT_GT(camera.eye.y, kSize.y);
  }
}

TEST(AutoCamera, IsUsableForEmptyAndFlatScenes) {
  EXPECT_NE(auto_camera(Scene{}).eye, auto_camera(Scene{}).target);
  Scene flat;
  add_quad(flat, {}, {1, 0, 0}, {0, 1, 0});
  EXPECT_TRUE(shows_all(auto_camera(flat), flat));
}

}  // namespace
}  // namespace relumbre
