#include "relumbre/render/view.h"

#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/render/view_test_support.h"

namespace relumbre {
namespace {

using test::ahead;
using test::furnace;
using test::Lit;

ViewConfig small(ViewMode mode = ViewMode::kGouraud) {
  return {.width = 37, .height = 23, .samples = 4, .mode = mode, .light_samples = 16};
}

TEST(View, UniformFurnaceIsTheSameEverywhere) {
  Camera camera = ahead();
  camera.eye = {0.3F, -0.2F, 0.5F};
  camera.vfov_deg = 100;
  for (const ViewMode mode : {ViewMode::kGouraud, ViewMode::kDirectPerPixel}) {
    const Image image = furnace().render(camera, small(mode));
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      EXPECT_NEAR(image.rgb(i).x, 2, 1e-4F);
      EXPECT_NEAR(image.rgb(i).z, 2, 1e-4F);
      EXPECT_EQ(image.channel("A")[i], 1);
      EXPECT_EQ(image.channel("albedo.G")[i], 0.5F);
    }
  }
}

TEST(View, WallsSeenFromBehindAreNotSeen) {
  Camera camera = ahead();
  camera.eye = {0, 0, 30};
  const Image image = furnace().render(camera, small());
  const std::size_t center = 11 * 37 + 18;
  EXPECT_NEAR(image.channel("Z")[center], 31, 1e-3F);  // the far wall, through the near one
  EXPECT_NEAR(image.rgb(center).x, 2, 1e-4F);
  EXPECT_EQ(image.channel("A")[0], 0);
  EXPECT_EQ(image.channel("Z")[0], std::numeric_limits<float>::infinity());
}

TEST(View, DepthIsPlanarAndNormalsFaceTheCamera) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F), {}, true);
  test::add_quad(scene, m, {-50, -50, 0}, {100, 0, 0}, {0, 100, 0});
  const Lit lit(std::move(scene), 4, 8);
  for (const float z : {2.0F, -2.0F}) {
    Camera camera = ahead();
    camera.eye.z = z;
    const Image image = lit.render(camera, small());
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      EXPECT_NEAR(image.channel("Z")[i], 2, 1e-4F);
      EXPECT_NEAR(image.channel("N.Z")[i], z / 2, 1e-5F);
    }
  }
}

TEST(View, PixelsAreIrradianceTimesReflectancePlusEmission) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb{0.5F, 0.25F, 0.75F}, Rgb{1, 0, 0});
  test::add_quad(scene, m, {-50, -50, 0}, {100, 0, 0}, {0, 100, 0});
  Lit lit(std::move(scene), 4, 8);
  lit.lights = {test::emitter_light(0)};
  lit.lights[0].intensity = 3;
  lit.lit.emission.assign(8, Rgb{3, 0, 0});
  lit.lit.direct_irradiance.assign(8, Rgb(1.0F));
  lit.lit.radiosity.assign(8, Rgb{4, 0.5F, 1.5F});  // irradiance 2
  const Image image = lit.render(ahead(), small());
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    EXPECT_NEAR(image.rgb(i).x, 4, 1e-5F);
    EXPECT_NEAR(image.rgb(i).y, 0.5F, 1e-5F);
    EXPECT_NEAR(image.rgb(i).z, 1.5F, 1e-5F);
  }
}

TEST(View, DirectLightPerPixelFollowsThePointLightsLaw) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  test::add_quad(scene, m, {-5, -5, 0}, {10, 0, 0}, {0, 10, 0});
  Lit lit(std::move(scene), 2, 2);
  Light point;
  point.position = {0.3F, 0.2F, 0.5F};
  point.intensity = 2;
  lit.lights = {point};
  ViewConfig config = small(ViewMode::kDirectPerPixel);
  config.samples = 1;
  const Image image = lit.render(ahead(), config);
  const float half = 2 * std::tan(22.5F * std::numbers::pi_v<float> / 180);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float x = (static_cast<float>(i % 37) + 0.5F - 18.5F) / 11.5F * half;
    const float y = (11.5F - static_cast<float>(i / 37) - 0.5F) / 11.5F * half;
    const Vec3f d = point.position - Vec3f{x, y, 0};
    const float expected = 0.5F * 2 * d.z / std::pow(length(d), 3.0F);
    EXPECT_NEAR(image.rgb(i).x, expected, 2e-3F * expected);
  }
}

TEST(View, AreaLightPerPixelAgreesWithTheElements) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  test::add_quad(scene, m, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  Lit lit(std::move(scene), 4, 4000);
  lit.lights = {test::quad_light({-0.2F, -0.2F, 0.5F}, {0, 0.4F, 0}, {0.4F, 0, 0})};
  const auto response = light_response(lit.cut.scene, lit.cut.tessellation, lit.cut.rays,
                                       lit.lights[0], {.points_per_element = 64});
  lit.lit.direct_irradiance = response;
  for (std::size_t i = 0; i < response.size(); ++i) {
    lit.lit.radiosity[i] = response[i] * lit.reflectance[i];
  }
  Camera camera = ahead();
  camera.vfov_deg = 40;
  ViewConfig config = small();
  config.width = 23;
  const Image interpolated = lit.render(camera, config);
  config.mode = ViewMode::kDirectPerPixel;
  config.light_samples = 256;
  const Image per_pixel = lit.render(camera, config);
  for (std::size_t i = 0; i < interpolated.pixels(); ++i) {
    EXPECT_NEAR(per_pixel.rgb(i).x, interpolated.rgb(i).x, 0.04F * interpolated.rgb(i).x + 2e-3F);
  }
}

TEST(View, SkyShowsWhereNothingIsHit) {
  Lit lit = furnace();
  Light sky;
  sky.type = LightType::kSky;
  auto image = std::make_shared<Image>(rgb_image(4, 2));
  for (std::size_t i = 0; i < image->pixels(); ++i) image->set_rgb(i, Rgb{1, 2, 3});
  sky.sky = image;
  sky.intensity = 2;
  lit.lights.push_back(sky);
  Camera camera = ahead();
  camera.eye = {0, 0, 30};
  ViewConfig config = small();
  config.background = {7, 7, 7};
  EXPECT_NEAR(lit.render(camera, config).rgb(0).y, 4 * std::numbers::pi_v<float>, 1e-4F);
  lit.lights.back().on = false;
  EXPECT_EQ(lit.render(camera, config).rgb(0), (Rgb{7, 7, 7}));
}

TEST(View, IsFiniteWithBlackSurfaces) {
  Scene scene;
  test::add_room(scene, test::add_material(scene, Rgb{0, 0.5F, 0}), {-1, -1, -1}, {1, 1, 1});
  test::add_quad(scene, test::add_material(scene, Rgb{}), {-0.5F, -0.5F, -0.5F}, {1, 0, 0},
                 {0, 1, 0});
  Lit lit(std::move(scene), 14, 100);
  lit.lit.direct_irradiance.assign(100, Rgb(1.0F));
  for (std::size_t i = 0; i < 100; ++i) lit.lit.radiosity[i] = lit.reflectance[i] * 2.0F;
  Camera camera = ahead();
  camera.eye.z = 0.9F;
  const Image image = lit.render(camera, small());
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    EXPECT_TRUE(is_finite(image.rgb(i)));
    EXPECT_EQ(image.rgb(i).x, 0);
  }
}

TEST(View, IsTheSameForAnyNumberOfThreads) {
  const Lit lit = furnace();
  Camera camera = ahead();
  camera.eye = {0.3F, -0.2F, 0.5F};
  std::vector<std::vector<float>> planes;
  for (const std::size_t threads : {1U, 3U}) {
    const ThreadLimit limit(threads);
    const Image image = lit.render(camera, small(ViewMode::kDirectPerPixel));
    planes.emplace_back(image.channel("R").begin(), image.channel("R").end());
  }
  EXPECT_EQ(planes[0], planes[1]);
}

TEST(View, RefusesWhatItCannotRender) {
  const Lit lit = furnace();
  const auto refused = [&](auto&& change) {
    ViewConfig config = small();
    change(config);
    EXPECT_THROW((void)lit.render(ahead(), config), ValueError);
  };
  refused([](ViewConfig& c) { c.width = 0; });
  refused([](ViewConfig& c) { c.height = 0; });
  refused([](ViewConfig& c) { c.width = std::size_t{1} << 40, c.height = std::size_t{1} << 40; });
  refused([](ViewConfig& c) { c.samples = 0; });
  refused([](ViewConfig& c) { c.light_samples = 1U << 30; });
}

}  // namespace
}  // namespace relumbre
