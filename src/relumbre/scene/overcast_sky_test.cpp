#include "relumbre/scene/overcast_sky.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

TEST(OvercastSky, PutsSevenNinthsOfPiOnTheHorizontal) {
  const Image sky = overcast_sky();
  constexpr double pi = std::numbers::pi;
  double irradiance = 0;
  for (std::size_t row = 0; row < sky.height() / 2; ++row) {
    const double polar = pi * (static_cast<double>(row) + 0.5) / static_cast<double>(sky.height());
    const double band = 2 * pi * std::sin(polar) * pi / static_cast<double>(sky.height());
    irradiance += static_cast<double>(sky.rgb(row * sky.width()).y) * std::cos(polar) * band;
  }
  EXPECT_NEAR(irradiance, 7 * pi / 9, 2e-3);
}

TEST(OvercastSky, ZenithIsThreeTimesTheHorizon) {
  const Image sky = overcast_sky();
  const float zenith = sky.rgb(0).x, horizon = sky.rgb((sky.height() / 2 - 1) * sky.width()).x;
  EXPECT_NEAR(zenith, 1, 1e-2);
  EXPECT_NEAR(horizon, 1.0 / 3, 3e-2);
}

}  // namespace
}  // namespace relumbre
