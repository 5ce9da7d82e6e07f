#include "relumbre/render/response_cache.h"

#include <fstream>

#include <gtest/gtest.h>

#include "relumbre/base/npy.h"
#include "relumbre/render/test_support.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;
using test::Cut;

Scene lamp_scene(float exitance = 1) {
  Scene scene;
  test::add_quad(scene, test::add_material(scene, Rgb(0.5F)), {}, {1, 0, 0}, {0, 1, 0});
  test::add_quad(scene, test::add_material(scene, Rgb(0.0F), Rgb(exitance)), {0, 0, 1}, {0, 1, 0},
                 {1, 0, 0});
  return scene;
}

const Cut& lamp() {
  static const Cut cut(lamp_scene(), 4, 32);
  return cut;
}

ResponseCache cache_of(const Cut& cut, const fs::path& folder = {}) {
  return {cut.scene, cut.tessellation, cut.rays, {}, folder};
}

/// A folder of this test's own, gone afterwards.
class Folder {
 public:
  Folder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = fs::path(testing::TempDir()) / (std::string("relumbre_cache_") + info->name());
    fs::remove_all(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

TEST(ResponseCache, DimmingColouringAndSwitchingCostNoRays) {
  ResponseCache cache = cache_of(lamp());
  Light light = test::emitter_light(1);
  const LightResponse first = cache.response(light);
  const std::uint64_t rays = cache.counters().rays;
  EXPECT_GT(rays, 0U);
  light.intensity = 0.1F, light.color = {1, 0, 0};
  EXPECT_EQ(cache.response(light), first);
  light.on = false;
  EXPECT_EQ(cache.responses(std::span(&light, 1))[0], first);
  EXPECT_EQ(cache.counters().rays, rays);
  EXPECT_EQ(cache.counters().computed, 1U);
  EXPECT_EQ(cache.counters().from_memory, 2U);
}

TEST(ResponseCache, ALightThatIsOffCostsNoRays) {
  ResponseCache cache = cache_of(lamp());
  Light light = test::emitter_light(1);
  light.on = false;
  EXPECT_EQ(*cache.responses(std::span(&light, 1))[0],
            std::vector<Rgb>(lamp().tessellation.elements()));
  EXPECT_EQ(cache.counters().rays, 0U);
}

TEST(ResponseCache, KeyFollowsWhateverTheResponseDependsOn) {
  ResponseCache cache = cache_of(lamp());
  const Light light = test::quad_light({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  Light moved = light, other = light;
  moved.position.x += 1e-6F;
  other.type = LightType::kPoint;
  EXPECT_NE(cache.key(light), cache.key(moved));
  EXPECT_NE(cache.key(light), cache.key(other));

  const Cut brighter(lamp_scene(2), 4, 32), finer(lamp_scene(), 4, 33);
  EXPECT_NE(cache.key(test::emitter_light(1)), cache_of(brighter).key(test::emitter_light(1)));
  EXPECT_NE(cache.key(light), cache_of(finer).key(light));
  ResponseCache seeded(lamp().scene, lamp().tessellation, lamp().rays, {.seed = 2});
  EXPECT_NE(cache.key(light), seeded.key(light));
}

TEST(ResponseCache, SkiesAreToldApartByTheirPixels) {
  ResponseCache cache = cache_of(lamp());
  const auto sky = [](float value) {
    auto image = std::make_shared<Image>(rgb_image(2, 2));
    image->set_rgb(3, Rgb(value));
    Light light;
    light.type = LightType::kSky;
    light.sky = image;
    return light;
  };
  EXPECT_EQ(cache.key(sky(1)), cache.key(sky(1)));
  EXPECT_NE(cache.key(sky(1)), cache.key(sky(2)));
}

TEST(ResponseCache, FolderOutlivesTheCache) {
  const Folder folder;
  const Light light = test::emitter_light(1);
  const LightResponse first = cache_of(lamp(), folder.path()).response(light);
  ResponseCache again = cache_of(lamp(), folder.path());
  EXPECT_EQ(*again.response(light), *first);
  EXPECT_EQ(again.counters().rays, 0U);
  EXPECT_EQ(again.counters().from_disk, 1U);
}

TEST(ResponseCache, DamagedEntriesAreComputedAgain) {
  const Folder folder;
  const Light light = test::emitter_light(1);
  const LightResponse first = cache_of(lamp(), folder.path()).response(light);
  const fs::path file = fs::directory_iterator(folder.path())->path();
  const std::size_t n = lamp().tessellation.elements();
  const std::vector<std::function<void()>> damages = {
      [&] { fs::resize_file(file, fs::file_size(file) / 2); },
      [&] { std::ofstream(file) << "not an array"; },
      [&] {
        write_npy(file, std::array{n - 1, std::size_t{3}}, std::vector<float>(3 * n - 3));
      },
      [&] {
        write_npy(file, std::array{n, std::size_t{3}}, std::vector<float>(3 * n, NAN));
      },
      [&] {
        write_npy(file, std::array{n, std::size_t{3}}, std::vector<float>(3 * n, -1));
      }};
  for (const auto& damage : damages) {
    damage();
    ResponseCache cache = cache_of(lamp(), folder.path());
    EXPECT_EQ(*cache.response(light), *first);
    EXPECT_EQ(cache.counters().computed, 1U);
  }
  ResponseCache repaired = cache_of(lamp(), folder.path());
  EXPECT_EQ(*repaired.response(light), *first);
  EXPECT_EQ(repaired.counters().from_disk, 1U);
}

TEST(ResponseCache, UnwritableFolderIsAsGoodAsNone) {
  const Folder folder;
  std::ofstream(folder.path()) << "a file, not a folder";
  ResponseCache cache = cache_of(lamp(), folder.path() / "below");
  EXPECT_NE(cache.response(test::emitter_light(1)), nullptr);
  EXPECT_EQ(cache.counters().computed, 1U);
}

}  // namespace
}  // namespace relumbre
