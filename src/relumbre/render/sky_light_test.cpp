#include "relumbre/render/sky_light.h"

#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

Light sky_of(std::size_t width, std::size_t height, auto&& value) {
  auto image = std::make_shared<Image>(rgb_image(width, height));
  for (std::size_t i = 0; i < image->pixels(); ++i) {
    image->set_rgb(i, Rgb(value(i % width, i / width)));
  }
  Light light;
  light.name = "sky";
  light.type = LightType::kSky;
  light.sky = image;
  return light;
}

Light numbered() {
  return sky_of(8, 4, [](std::size_t x, std::size_t y) { return static_cast<float>(10 * y + x); });
}

TEST(SkyMap, CentreLooksAlongMinusZAndColumnsRunToPlusX) {
  const SkyMap sky(numbered());
  EXPECT_EQ(sky.radiance(normalized(Vec3f{0.1F, 0.1F, -1})).x, 14);  // centre, right and above
  EXPECT_EQ(sky.radiance(normalized(Vec3f{-0.1F, -0.1F, -1})).x, 23);
  EXPECT_EQ(sky.radiance(normalized(Vec3f{1, 0.1F, 0.1F})).x, 16);
  EXPECT_LT(sky.radiance({0, 1, 0}).x, 8);
  EXPECT_GE(sky.radiance({0, -1, 0}).x, 30);
}

TEST(SkyMap, RotationTurnsItCounterClockwiseSeenFromAbove) {
  Light light = numbered();
  const Vec3f ahead = normalized(Vec3f{0.1F, 0.1F, -1});
  const float before = SkyMap(light).radiance(ahead).x;
  light.rotation_deg = 90;  // −z goes to −x
  EXPECT_EQ(SkyMap(light).radiance(normalized(Vec3f{-1, 0.1F, -0.1F})).x, before);
}

TEST(SkyMap, DensityIsThatOfItsSamples) {
  const SkyMap sky(sky_of(6, 5, [](std::size_t x, std::size_t y) {
    return static_cast<float>((x * y) % 3) + (x == 2 && y == 1 ? 50.0F : 0.0F);
  }));
  // The mean of 1 / density over the samples is the solid angle of all that is not black; every
  // sample must land where the map is not black.
  double mean = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Vec3f d = sky.sample((static_cast<float>(i) + 0.5F) / kSteps,
                                 (static_cast<float>(j) + 0.5F) / kSteps);
      EXPECT_NEAR(length(d), 1, 1e-5F);
      ASSERT_GT(sky.density(d), 0);
      mean += 1 / static_cast<double>(sky.density(d)) / (kSteps * kSteps);
    }
  }
  double expected = 0;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 6; ++x) {
      if ((x * y) % 3 == 0 && !(x == 2 && y == 1)) continue;
      expected += 2 * std::numbers::pi / 6 *
                  (std::cos(std::numbers::pi * y / 5) - std::cos(std::numbers::pi * (y + 1) / 5));
    }
  }
  EXPECT_NEAR(mean, expected, 0.01 * expected);
}

TEST(SkyMap, DensityIntegratesToOne) {
  const SkyMap sky(numbered());
  double integral = 0;
  constexpr int kRows = 400, kColumns = 800;
  for (int i = 0; i < kRows; ++i) {
    const float y = 1 - 2 * (static_cast<float>(i) + 0.5F) / kRows, r = std::sqrt(1 - y * y);
    for (int j = 0; j < kColumns; ++j) {
      const float phi = 2 * kPi * (static_cast<float>(j) + 0.5F) / kColumns;
      integral += static_cast<double>(sky.density({r * std::cos(phi), y, r * std::sin(phi)}));
    }
  }
  EXPECT_NEAR(integral * 4 * std::numbers::pi / (kRows * kColumns), 1, 2e-3);
}

TEST(SkyMap, BlackSkyIsBlackAndNegativeCountsAsZero) {
  EXPECT_TRUE(SkyMap(sky_of(2, 2, [](std::size_t, std::size_t) { return -1.0F; })).black());
  EXPECT_FALSE(SkyMap(numbered()).black());
}

TEST(SkyMap, RefusesWhatIsNoSky) {
  EXPECT_THROW(SkyMap(Light{}), ValueError);
  EXPECT_THROW(SkyMap(sky_of(2, 1, [](std::size_t, std::size_t) { return NAN; })), ValueError);
}

}  // namespace
}  // namespace relumbre
