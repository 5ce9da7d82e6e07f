#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/render/primary_hits.h"
#include "relumbre/render/view_test_support.h"

namespace relumbre {
namespace {

using test::ahead;
using test::Lit;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A quad that faces +z, centred at (0, 0, z).
void add_sheet(Scene& scene, std::uint32_t material, float z, float half = 1) {
  test::add_quad(scene, material, {-half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0});
}

/// A closed box that faces outward.
void add_box(Scene& scene, std::uint32_t material, const Vec3f& lower, const Vec3f& upper) {
  const Vec3f d = upper - lower, x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
  test::add_quad(scene, material, lower, x, z);
  test::add_quad(scene, material, lower + y, z, x);
  test::add_quad(scene, material, lower, z, y);
  test::add_quad(scene, material, lower + x, y, z);
  test::add_quad(scene, material, lower, y, x);
  test::add_quad(scene, material, lower + z, x, y);
}

/// Makes all that is there so far one object, 0, and of what comes after other ones.
void join(Scene& scene) { std::ranges::fill(scene.mesh.object, 0U); }

/// Depth of what is behind the first surface along −z from (0, 0, 2); infinite where nothing is.
float depth_behind(const Scene& scene, float separation = 0.02F) {
  const RayScene rays(scene.mesh);
  const Ray ray{{0.01F, 0.02F, 2}, 0, {0, 0, -1}};
  Hit hit, behind;
  trace_primary(scene, rays, {&ray, 1}, {&hit, 1});
  trace_behind(scene, rays, {&ray, 1}, {&hit, 1}, separation, {&behind, 1});
  return behind.t;
}

TEST(Behind, ASheetIsTheNextSurface) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  add_sheet(scene, m, 0);
  add_sheet(scene, m, -1);
  add_sheet(scene, m, -3);
  EXPECT_NEAR(depth_behind(scene), 3, 1e-4F);
  EXPECT_NEAR(depth_behind(scene, 1), 5, 1e-4F);
  EXPECT_EQ(depth_behind(scene, 2), kInfinity);
}

TEST(Behind, TwoSidedSheetsHideNothing) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F), {}, true);
  add_sheet(scene, m, 0);
  add_sheet(scene, m, -1);
  EXPECT_NEAR(depth_behind(scene), 3, 1e-4F);
}

TEST(Behind, TheInsideOfASolidIsPassedOver) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  add_box(scene, m, {-1, -1, -1}, {1, 1, 0});
  add_box(scene, m, {-0.5F, -0.5F, -0.8F}, {0.5F, 0.5F, -0.3F});  // a part that sticks in it
  join(scene);
  EXPECT_EQ(depth_behind(scene), kInfinity);
  add_sheet(scene, m, -4);
  EXPECT_NEAR(depth_behind(scene), 6, 1e-4F);
}

TEST(Behind, PartsThatReachOutOfASolidAreSolid) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  add_box(scene, m, {-1, -1, -1}, {1, 1, 0});
  add_box(scene, m, {-0.5F, -0.5F, -1.8F}, {0.5F, 0.5F, -0.3F});
  join(scene);
  add_sheet(scene, m, -4);
  EXPECT_NEAR(depth_behind(scene), 6, 1e-4F);
}

TEST(Behind, AnotherObjectIsSeenThoughItReachesIntoTheFirst) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  add_box(scene, m, {-1, -1, -1}, {1, 1, 0});
  join(scene);
  add_box(scene, m, {-0.5F, -0.5F, -1.8F}, {0.5F, 0.5F, -0.3F});
  EXPECT_NEAR(depth_behind(scene), 2.3F, 1e-4F);
}

TEST(Behind, ABoxWithoutABackIsNotEndless) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  add_sheet(scene, m, 0);  // the front of a box that stands on what follows
  add_sheet(scene, m, -1);
  EXPECT_NEAR(depth_behind(scene), 3, 1e-4F);
}

TEST(Behind, NothingIsBehindNothing) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  add_sheet(scene, m, 5);  // behind the camera
  EXPECT_EQ(depth_behind(scene), kInfinity);
}

/// A green square before a larger red one, both glowing.
Lit squares() {
  Scene scene;
  add_sheet(scene, test::add_material(scene, Rgb{}, Rgb{0, 1, 0}), 0, 0.3F);
  add_sheet(scene, test::add_material(scene, Rgb{}, Rgb{1, 0, 0}), -1, 0.8F);
  Lit lit(std::move(scene), 2, 8);
  lit.lights = {test::emitter_light(0), test::emitter_light(1)};
  return lit;
}

TEST(Layers, SecondIsThePictureWithoutTheFirstSurface) {
  ViewConfig config{.width = 41, .height = 31, .samples = 16, .mode = ViewMode::kGouraud};
  config.background = {0, 0, 7};
  config.layers = 2;
  const Image image = squares().render(ahead(), config);
  const auto rgb = [&](std::size_t i) {
    return Rgb{image.channel("layer1.R")[i], image.channel("layer1.G")[i],
               image.channel("layer1.B")[i]};
  };
  const std::size_t middle = 15 * 41 + 20;
  EXPECT_EQ(image.rgb(middle), (Rgb{0, 1, 0}));
  EXPECT_EQ(rgb(middle), (Rgb{1, 0, 0}));
  EXPECT_EQ(image.channel("layer1.A")[middle], 1);
  EXPECT_NEAR(image.channel("layer1.Z")[middle], 3, 1e-4F);
  for (const std::size_t i : {std::size_t{0}, std::size_t{15 * 41 + 29}}) {  // sky; red alone
    EXPECT_EQ(image.channel("layer1.A")[i], 0);
    EXPECT_EQ(image.channel("layer1.Z")[i], kInfinity);
    EXPECT_EQ(rgb(i), (Rgb{0, 0, 7}));
  }
  EXPECT_EQ(image.rgb(15 * 41 + 29), (Rgb{1, 0, 0}));
}

TEST(Layers, TheFirstIsTheSameWithAndWithoutASecond) {
  ViewConfig config{.width = 41, .height = 31, .samples = 4, .mode = ViewMode::kDirectPerPixel};
  const Image one = squares().render(ahead(), config);
  config.layers = 2;
  const Image two = squares().render(ahead(), config);
  for (const Image::Channel& channel : one.channels()) {
    const auto other = two.channel(channel.name);
    EXPECT_TRUE(std::equal(other.begin(), other.end(), channel.values.begin())) << channel.name;
  }
  EXPECT_FALSE(one.has("layer1.A"));
}

TEST(Layers, RefusesOtherNumbers) {
  const Lit lit = squares();
  ViewConfig config{.width = 4, .height = 4};
  for (const std::uint32_t layers : {0U, 3U}) {
    config.layers = layers;
    EXPECT_THROW((void)lit.render(ahead(), config), ValueError);
  }
  config.layers = 2;
  for (const float separation : {-0.1F, kInfinity, std::nanf("")}) {
    config.layer_separation = separation;
    EXPECT_THROW((void)lit.render(ahead(), config), ValueError);
  }
}

}  // namespace
}  // namespace relumbre
