#include "relumbre/render/lens_view.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/render/camera_rays.h"
#include "relumbre/render/lens_samples.h"
#include "relumbre/render/view_test_support.h"

namespace relumbre {
namespace {

using test::ahead;
using test::furnace;
using test::Lit;

/// Focused at 2 m, with blurs of up to 24 pixels at infinity in a picture 96 pixels wide.
LensViewConfig lens_config(std::uint32_t samples = 256) {
  LensViewConfig config;
  config.view = {.width = 96, .height = 80, .samples = samples, .mode = ViewMode::kGouraud};
  config.lens = {.focal_length_mm = 50, .f_number = 1, .focus_distance_m = 2, .sensor_width_mm = 1};
  config.lens.f_number = 50.0 * 50 / 1950 * 96 / 24;
  return config;
}

/// A square that glows, `side` metres wide, at `depth` before the camera of ahead(), left and above
/// of its axis.
Lit glowing_square(float depth, float side, const Vec3f& shift = {-0.2F, 0.15F, 0}) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb{}, Rgb{2, 3, 4});
  test::add_quad(scene, m, Vec3f{-side / 2, -side / 2, 2 - depth} + shift, {side, 0, 0},
                 {0, side, 0});
  Lit lit(std::move(scene), 1, 2);
  lit.lights = {test::emitter_light(0)};
  return lit;
}

Image through_lens(const Lit& lit, const LensViewConfig& config, const Camera& camera = ahead()) {
  return render_lens_view({lit.cut.scene, lit.cut.tessellation, lit.display, lit.cut.rays,
                           lit.reflectance, lit.lights, lit.lit},
                          camera, config);
}

/// Sum, centre, and central moments of a plane; y points up.
struct Moments {
  double sum = 0, x = 0, y = 0, xx = 0, yy = 0, yyy = 0;
};

Moments moments(const Image& image, const char* channel = "R") {
  const std::span<const float> plane = image.channel(channel);
  Moments m;
  const auto each = [&](auto&& add) {
    for (std::size_t i = 0; i < plane.size(); ++i) {
      add(static_cast<double>(plane[i]), static_cast<double>(i % image.width()) + 0.5,
          static_cast<double>(image.height()) - 0.5 - static_cast<double>(i / image.width()));
    }
  };
  each([&](double v, double x, double y) { m.sum += v, m.x += v * x, m.y += v * y; });
  m.x /= m.sum, m.y /= m.sum;
  each([&](double v, double x, double y) {
    const double dx = x - m.x, dy = y - m.y;
    m.xx += v * dx * dx, m.yy += v * dy * dy, m.yyy += v * dy * dy * dy;
  });
  m.xx /= m.sum, m.yy /= m.sum, m.yyy /= m.sum;
  return m;
}

/// A square that is 5 pixels wide in focus: a smaller one is hit by too few of the rays.
constexpr double kSquare = 5;
double pixels_per_tangent(const LensViewConfig& config) {
  return CameraRays(ahead(), config.view.width, config.view.height).pixels_per_tangent();
}

float square_side(const LensViewConfig& config, double depth) {
  return static_cast<float>(kSquare * depth / pixels_per_tangent(config));
}

TEST(LensView, APointBecomesADiscOfTheFormulasSize) {
  for (const double depth : {1.0, 1.6, 3.0, 5.0}) {
    const LensViewConfig config = lens_config(1024);
    const Lit lit = glowing_square(static_cast<float>(depth), square_side(config, depth));
    const Moments m = moments(through_lens(lit, config));
    const double coc = config.lens.coc_diameter_pixels(depth, config.view.width);
    // Variances add up: of the disc, of the square, of the tent filter.
    const double expected = coc * coc / 16 + kSquare * kSquare / 12 + 1.0 / 6;
    EXPECT_NEAR(std::sqrt(m.xx), std::sqrt(expected), 0.05) << depth;
    EXPECT_NEAR(std::sqrt(m.yy), std::sqrt(expected), 0.05) << depth;
  }
}

TEST(LensView, TheDiscIsEvenAndHasARim) {
  const LensViewConfig config = lens_config(2048);
  const Lit lit = glowing_square(5, square_side(config, 5), {});
  const Image image = through_lens(lit, config);
  const double radius = config.lens.coc_diameter_pixels(5, config.view.width) / 2;
  const Moments m = moments(image);
  const double inside = m.sum / (std::numbers::pi * radius * radius);  // of red, 2 on 25 pixels
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const double x = static_cast<double>(i % 96) + 0.5 - 48,
                 y = static_cast<double>(i / 96) + 0.5 - 40;
    const double r = std::hypot(x, y);
    if (r < radius - 5) {
      EXPECT_NEAR(image.rgb(i).x, inside, 0.12 * inside);
    }
    if (r > radius + 5) {
      EXPECT_EQ(image.rgb(i).x, 0);
    }
  }
}

TEST(LensView, EnergyIsKeptWhateverTheBlur) {
  for (const float depth : {1.0F, 2.0F, 5.0F}) {
    const LensViewConfig config = lens_config(512);
    const Lit lit = glowing_square(depth, square_side(config, static_cast<double>(depth)));
    const Moments m = moments(through_lens(lit, config), "B");
    EXPECT_NEAR(m.sum, 4 * kSquare * kSquare, 0.01 * 4 * kSquare * kSquare) << depth;
  }
}

TEST(LensView, BladesMakeAPolygonWithItsCornersOnTheDisc) {
  for (const int blades : {3, 6, 8}) {
    LensViewConfig config = lens_config(512);
    config.aperture = {blades, 12};
    const Moments m = moments(through_lens(glowing_square(5, square_side(config, 5)), config));
    const double coc = config.lens.coc_diameter_pixels(5, config.view.width);
    const double expected = coc * coc / 4 * (2 + std::cos(2 * std::numbers::pi / blades)) / 12 +
                            kSquare * kSquare / 12 + 1.0 / 6;
    EXPECT_NEAR(std::sqrt(m.xx), std::sqrt(expected), 0.06) << blades;
    EXPECT_NEAR(std::sqrt(m.yy), std::sqrt(expected), 0.06) << blades;
  }
}

TEST(LensView, TheShapeStandsBehindTheFocusAndIsTurnedBeforeIt) {
  LensViewConfig config = lens_config(512);
  config.aperture = {3, 90};  // a corner on top
  EXPECT_GT(moments(through_lens(glowing_square(5, square_side(config, 5)), config)).yyy, 5);
  EXPECT_LT(moments(through_lens(glowing_square(1.3F, square_side(config, 1.3)), config)).yyy, -5);
}

TEST(LensView, WhatIsInFocusIsAsSharpAsThroughAPinhole) {
  const LensViewConfig config = lens_config(512);
  const Lit lit = glowing_square(2, 0.4F);
  ViewConfig pinhole = config.view;
  pinhole.samples = 1024;
  const Image sharp = lit.render(ahead(), pinhole), lens = through_lens(lit, config);
  for (std::size_t i = 0; i < sharp.pixels(); ++i) {
    EXPECT_NEAR(lens.rgb(i).x, sharp.rgb(i).x, 0.04F);
    EXPECT_NEAR(lens.channel("A")[i], sharp.channel("A")[i], 0.02F);
  }
}

TEST(LensView, BlurDoesNotDependOnTheResolution) {
  LensViewConfig config = lens_config(512);
  const Lit lit = glowing_square(5, square_side(config, 5));
  const double small = std::sqrt(moments(through_lens(lit, config)).xx - 1.0 / 6);
  config.view.width *= 2, config.view.height *= 2, config.view.samples = 128;
  EXPECT_NEAR(std::sqrt(moments(through_lens(lit, config)).xx - 1.0 / 6), 2 * small, 0.05);
}

TEST(LensView, UniformLightStaysUniform) {
  Camera camera = ahead();
  camera.eye = {0.1F, -0.1F, 0.5F};
  for (const ViewMode mode : {ViewMode::kGouraud, ViewMode::kDirectPerPixel}) {
    LensViewConfig config = lens_config(17);  // no multiple of a packet
    config.view.width = 21, config.view.height = 13, config.view.mode = mode;
    config.lens.focus_distance_m = 1;
    config.lens.f_number = 400;
    const Lit room = furnace();
    const Image image = through_lens(room, config, camera);
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      EXPECT_NEAR(image.rgb(i).x, 2, 1e-4F);
      EXPECT_EQ(image.channel("A")[i], 1);
    }
  }
}

TEST(LensView, OtherChannelsAreThePinholes) {
  LensViewConfig config = lens_config(4);
  const Lit lit = glowing_square(3, 1);
  const Image lens = through_lens(lit, config), pinhole = lit.render(ahead(), config.view);
  for (const char* channel : {"Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"}) {
    const auto a = lens.channel(channel), b = pinhole.channel(channel);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin())) << channel;
  }
  const std::vector<float> depth =
      pinhole_depth(lit.cut.scene, lit.cut.rays, ahead(), config.view.width, config.view.height);
  const auto z = lens.channel("Z");
  EXPECT_TRUE(std::equal(z.begin(), z.end(), depth.begin()));
}

TEST(LensView, WallsSeenFromBehindAreNotSeen) {
  Camera camera = ahead();
  camera.eye = {0, 0, 6};
  LensViewConfig config = lens_config(32);
  config.view.width = 11, config.view.height = 9;
  const Lit room = furnace();
  const Image image = through_lens(room, config, camera);
  EXPECT_NEAR(image.rgb(4 * 11 + 5).x, 2, 1e-4F);
}

TEST(LensView, IsTheSameForAnyNumberOfThreads) {
  LensViewConfig config = lens_config(20);
  config.view.mode = ViewMode::kDirectPerPixel;
  config.view.width = 19, config.view.height = 11;
  const Lit room = furnace();
  std::vector<std::vector<float>> planes;
  for (const std::size_t threads : {1U, 3U}) {
    const ThreadLimit limit(threads);
    const Image image = through_lens(room, config);
    planes.emplace_back(image.channel("G").begin(), image.channel("G").end());
  }
  EXPECT_EQ(planes[0], planes[1]);
}

TEST(LensView, RefusesWhatItCannotRender) {
  const Lit lit = glowing_square(3, 1);
  const auto refused = [&](const std::function<void(LensViewConfig&)>& change) {
    LensViewConfig config = lens_config(1);
    change(config);
    EXPECT_THROW((void)through_lens(lit, config), ValueError);
  };
  refused([](LensViewConfig& c) { c.lens.f_number = 0; });
  refused([](LensViewConfig& c) { c.lens.focus_distance_m = 0.05; });
  refused([](LensViewConfig& c) { c.lens.focus_distance_m = std::nan(""); });
  refused([](LensViewConfig& c) { c.aperture.blades = 2; });
  refused([](LensViewConfig& c) { c.view.samples = 0; });
  refused([](LensViewConfig& c) { c.view.samples = (1U << 16) + 1; });
  refused([](LensViewConfig& c) { c.view.layers = 2; });
  refused([](LensViewConfig& c) { c.view.width = 0; });
}

TEST(LensSamples, FillLensAndPixelEvenly) {
  const LensSamples samples({}, 256, 5);
  for (const std::size_t pixel : {0U, 1U, 77U}) {
    std::vector<int> sectors(16), columns(16), indices(256);
    for (const LensSample& s : samples.of_pixel(pixel)) {
      const double r2 = static_cast<double>(s.lens.x * s.lens.x + s.lens.y * s.lens.y);
      ASSERT_LE(r2, 1.00001);
      // A tent's distribution function gives back the uniform number.
      const double t = static_cast<double>(s.pixel.x);
      const double u = t < 0 ? (1 + t) * (1 + t) / 2 : 1 - (1 - t) * (1 - t) / 2;
      ++columns[static_cast<std::size_t>(std::min(15.0, u * 16))];
      ++sectors[static_cast<std::size_t>((s.lens.x > 0 ? 1 : 0) + (s.lens.y > 0 ? 2 : 0))];
      ++indices[s.index];
    }
    for (const int n : columns) EXPECT_EQ(n, 16);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(sectors[i], 64);
    for (const int n : indices) EXPECT_EQ(n, 1);
  }
}

TEST(LensSamples, NeighboursDiffer) {
  const LensSamples samples({}, 16, 5);
  std::size_t same = 0;
  for (std::size_t p = 0; p < 200; ++p) {
    same += samples.of_pixel(p).data() == samples.of_pixel(p + 1).data() ? 1 : 0;
  }
  EXPECT_LT(same, 15U);
}

TEST(CameraRays, LensRaysMeetWhereThePinholeRayMeetsThePlaneInFocus) {
  const CameraRays rays(ahead(), 40, 30);
  const Ray pinhole = rays.through(7, 11), lens = rays.through_lens(7, 11, {0.1F, -0.2F}, 3);
  EXPECT_NEAR(lens.origin.x - pinhole.origin.x, 0.1F, 1e-6F);
  EXPECT_NEAR(lens.origin.y - pinhole.origin.y, -0.2F, 1e-6F);
  EXPECT_NEAR(
      length(lens.origin + lens.direction * 3.0F - pinhole.origin - pinhole.direction * 3.0F), 0,
      1e-5F);
  EXPECT_NEAR(dot(lens.direction, rays.forward()), 1, 1e-6F);
}

}  // namespace
}  // namespace relumbre
