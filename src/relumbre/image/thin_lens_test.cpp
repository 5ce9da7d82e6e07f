#include "relumbre/image/thin_lens.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(ThinLens, CircleOfConfusionByHand) {
  // 50 mm f/2 focused at 1.05 m: c = 2500 · 1050 / (2100 · 2 · 1000) mm = 0.625 mm at 2.1 m.
  const ThinLens lens{50, 2, 1.05, 36};
  EXPECT_NEAR(lens.coc_diameter_pixels(2.1, 3600), 62.5, 1e-9);
  EXPECT_NEAR(lens.signed_coc_diameter_pixels(0.525, 3600), -125, 1e-9);
  EXPECT_NEAR(lens.coc_diameter_pixels(0.525, 3600), 125, 1e-9);
  EXPECT_EQ(lens.coc_diameter_pixels(1.05, 3600), 0);
  EXPECT_NEAR(lens.coc_diameter_pixels(kInfinity, 3600), 125, 1e-9);
  EXPECT_NEAR(lens.coc_at_infinity_pixels(3600), 125, 1e-9);
}

TEST(ThinLens, BlurKeepsItsShareOfThePictureAtAnySize) {
  const ThinLens lens;
  EXPECT_NEAR(lens.coc_diameter_pixels(5, 1280) / 1280, lens.coc_diameter_pixels(5, 3840) / 3840,
              1e-12);
}

TEST(ThinLens, OpeningIsFOverNAtTheLensesOwnAngleOfView) {
  const ThinLens lens{50, 1.4, 2, 36};
  const double image_distance_mm = 50.0 * 2000 / (2000 - 50);
  const double pixels_per_tangent = image_distance_mm / 36 * 1280;
  EXPECT_NEAR(lens.opening_diameter_m(pixels_per_tangent, 1280), 0.050 / 1.4, 1e-12);
}

TEST(ThinLens, RefusesWhatNoLensHas) {
  const auto refused = [](const std::function<void(ThinLens&)>& change) {
    ThinLens lens;
    change(lens);
    EXPECT_THROW(lens.check(), ValueError);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan, kInfinity}) {
    refused([&](ThinLens& l) { l.f_number = bad; });
    refused([&](ThinLens& l) { l.focal_length_mm = bad; });
    refused([&](ThinLens& l) { l.focus_distance_m = bad; });
    refused([&](ThinLens& l) { l.sensor_width_mm = bad; });
  }
  refused([](ThinLens& l) { l.focus_distance_m = 0.05; });  // at the focal length
  refused([](ThinLens& l) { l.focus_distance_m = 0.04; });  // inside it
  EXPECT_NO_THROW(ThinLens{}.check());
}

TEST(Focus, IsTheDepthOfWhatIsThere) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> depth{inf, 3, 0, -1, std::nanf(""), 2};
  EXPECT_EQ(focus_on_pixel(depth, 3, 2, 1, 0), 3);
  EXPECT_EQ(focus_on_pixel(depth, 3, 2, 2, 1), 2);
  EXPECT_EQ(focus_on_nearest(depth), 2);
  for (const std::size_t x : {0U, 2U}) {
    EXPECT_THROW((void)focus_on_pixel(depth, 3, 2, x, 0), ValueError);
  }
  EXPECT_THROW((void)focus_on_pixel(depth, 3, 2, 3, 0), ValueError);
  EXPECT_THROW((void)focus_on_pixel(depth, 3, 2, 0, 2), ValueError);
  EXPECT_THROW((void)focus_on_pixel(depth, 4, 2, 0, 0), ShapeError);
  EXPECT_THROW((void)focus_on_nearest(std::vector<float>{inf, 0}), ValueError);
  EXPECT_THROW((void)focus_on_nearest({}), ValueError);
}

TEST(Aperture, PointsLieInThePolygonAndFillIt) {
  for (const int blades : {0, 3, 5, 6, 8}) {
    const Aperture aperture{blades, 17};
    aperture.check();
    const double apothem = blades == 0 ? 1 : std::cos(std::numbers::pi / blades);
    Vec3d sum;
    double second = 0;
    constexpr std::uint32_t n = 1U << 14;
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto s = sobol4(i);
      const Vec2f p = aperture.point(to_unit(s[0]), to_unit(s[1]));
      const double x = static_cast<double>(p.x), y = static_cast<double>(p.y);
      sum += Vec3d{x, y, 0};
      second += x * x + y * y;
      EXPECT_LE(std::hypot(x, y), 1 + 1e-6);
      for (int b = 0; b < blades; ++b) {
        const double a = 17 * std::numbers::pi / 180 + (b + 0.5) * 2 * std::numbers::pi / blades;
        EXPECT_LE(x * std::cos(a) + y * std::sin(a), apothem + 1e-6);
      }
    }
    EXPECT_NEAR(length(sum) / n, 0, 1e-3);
    // Polar second moment over area of a regular polygon of circumradius 1.
    const double expected = blades == 0 ? 0.5 : (2 + std::cos(2 * std::numbers::pi / blades)) / 6;
    EXPECT_NEAR(second / n, expected, 1e-3) << blades;
  }
}

TEST(Aperture, OpenFractionIsThePolygonsArea) {
  EXPECT_EQ(Aperture{}.open_fraction(), 1);
  EXPECT_NEAR((Aperture{4, 0}.open_fraction()), 2 / std::numbers::pi, 1e-12);
  EXPECT_NEAR((Aperture{64, 0}.open_fraction()), 1, 2e-3);
}

TEST(Aperture, RefusesBladesThatEncloseNothing) {
  for (const int blades : {-1, 1, 2, 65}) EXPECT_THROW((Aperture{blades, 0}.check()), ValueError);
  EXPECT_THROW((Aperture{6, kInfinity}.check()), ValueError);
}

}  // namespace
}  // namespace relumbre
