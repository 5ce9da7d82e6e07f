#include "relumbre/image/silhouette.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/image/flip.h"
#include "relumbre/image/metrics.h"

namespace relumbre {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Every pixel within the radius of every silhouette pixel, one by one.
std::vector<std::uint8_t> brute_band(const std::vector<float>& depth, int width, int height,
                                     double radius) {
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * width + x); };
  const std::vector<std::uint8_t> edges =
      silhouette_band(depth, static_cast<std::size_t>(width), static_cast<std::size_t>(height),
                      {.radius_pixels = 0});
  std::vector<std::uint8_t> band(depth.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
          if (edges[at(i, j)] != 0 && std::hypot(i - x, j - y) <= radius) band[at(x, y)] = 1;
  return band;
}

TEST(Silhouette, LiesOnBothSidesOfAJump) {
  const std::vector<float> depth{1, 1, 1, 2, 2, 2};
  EXPECT_EQ(silhouette_band(depth, 6, 1, {.radius_pixels = 0}),
            (std::vector<std::uint8_t>{0, 0, 1, 1, 0, 0}));
  EXPECT_EQ(silhouette_band(depth, 6, 1, {.radius_pixels = 1}),
            (std::vector<std::uint8_t>{0, 1, 1, 1, 1, 0}));
  EXPECT_EQ(silhouette_band(depth, 1, 6, {.radius_pixels = 1.9}),
            (std::vector<std::uint8_t>{0, 1, 1, 1, 1, 0}));
}

TEST(Silhouette, AJumpIsRelativeToTheNearerDepth) {
  for (const float scale : {0.01F, 1.0F, 1000.0F}) {
    const std::vector<float> depth{scale, 1.09F * scale, 1.21F * scale};
    EXPECT_EQ(silhouette_band(depth, 3, 1, {.relative_jump = 0.1, .radius_pixels = 0}),
              (std::vector<std::uint8_t>{0, 1, 1}));
  }
}

TEST(Silhouette, NothingIsInfinitelyFar) {
  const std::vector<float> depth{kInfinity, std::nanf(""), 0, -1, 5};
  EXPECT_EQ(silhouette_band(depth, 5, 1, {.radius_pixels = 0}),
            (std::vector<std::uint8_t>{0, 0, 0, 1, 1}));
}

TEST(Silhouette, ASlopeIsNone) {
  std::vector<float> depth;
  for (int i = 0; i < 40; ++i) depth.push_back(5 + 0.1F * static_cast<float>(i % 8));
  for (const std::uint8_t m : silhouette_band(depth, 8, 5)) EXPECT_EQ(m, 0);
}

TEST(Silhouette, BandIsEveryPixelWithinTheRadius) {
  RandomStream random(3);
  std::vector<float> depth(31 * 23, 2.0F);
  for (int k = 0; k < 4; ++k) depth[random.bits() % depth.size()] = 9;
  for (const double radius : {0.0, 1.0, 1.5, 4.0, 7.3, 100.0}) {
    EXPECT_EQ(silhouette_band(depth, 31, 23, {.radius_pixels = radius}),
              brute_band(depth, 31, 23, radius))
        << radius;
  }
}

TEST(Silhouette, RefusesWhatHasNoMeaning) {
  const std::vector<float> depth(6, 1.0F);
  EXPECT_THROW((void)silhouette_band(depth, 4, 2), ShapeError);
  EXPECT_THROW((void)silhouette_band({}, 0, 0), ShapeError);
  EXPECT_THROW((void)silhouette_band(depth, 3, 2, {.relative_jump = 0}), ValueError);
  EXPECT_THROW((void)silhouette_band(depth, 3, 2, {.radius_pixels = -1}), ValueError);
  EXPECT_THROW((void)silhouette_band(depth, 3, 2, {.radius_pixels = 1e9}), ValueError);
}

// Metrics over a mask.

Image noise(std::size_t width, std::size_t height, std::uint64_t seed) {
  Image image = rgb_image(width, height);
  RandomStream random(seed);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float r = random.uniform(), g = random.uniform(), b = random.uniform();
    image.set_rgb(i, {r, g, b});
  }
  return image;
}

TEST(MaskedMetrics, AFullMaskIsNoMask) {
  const Image a = noise(23, 17, 1), b = noise(23, 17, 2);
  const std::vector<std::uint8_t> all(a.pixels(), 1);
  EXPECT_EQ(mean_squared_error(a, b, all), mean_squared_error(a, b));
  EXPECT_EQ(ssim(a, b, 1, SsimOf::kRgbMean, all), ssim(a, b, 1, SsimOf::kRgbMean));
  EXPECT_EQ(compare_tone_mapped(a, b, {}, all).psnr_db, compare_tone_mapped(a, b).psnr_db);
}

TEST(MaskedMetrics, TheWholeIsTheMeanOfTheParts) {
  const Image a = noise(23, 17, 1), b = noise(23, 17, 2);
  std::vector<std::uint8_t> part(a.pixels()), rest(a.pixels());
  double windows_in_part = 0, windows = 0, in_part = 0;
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    const std::size_t x = i % 23, y = i / 23;
    part[i] = i % 3 == 0 ? 1 : 0, rest[i] = i % 3 == 0 ? 0 : 1;
    in_part += part[i];
    if (x < 5 || y < 5 || x >= 18 || y >= 12) continue;
    windows += 1, windows_in_part += part[i];
  }
  const double f = in_part / static_cast<double>(a.pixels()), g = windows_in_part / windows;
  EXPECT_NEAR(f * mean_squared_error(a, b, part) + (1 - f) * mean_squared_error(a, b, rest),
              mean_squared_error(a, b), 1e-12);
  const auto ssim_of = [&](PixelMask mask) { return ssim(a, b, 1, SsimOf::kLuminance, mask); };
  EXPECT_NEAR(g * ssim_of(part) + (1 - g) * ssim_of(rest), ssim_of({}), 1e-12);
}

TEST(MaskedMetrics, SeeOnlyWhatTheMaskHolds) {
  const Image a = noise(23, 17, 1);
  Image b = a;
  b.set_rgb(0, Rgb(9.0F));
  std::vector<std::uint8_t> mask(a.pixels(), 1);
  mask[0] = 0;
  EXPECT_EQ(mean_squared_error(a, b, mask), 0);
  EXPECT_TRUE(std::isinf(psnr(a, b, 1, mask)));
}

TEST(MaskedMetrics, AnEmptyMaskHasNoMeanAndAWrongOneIsRefused) {
  const Image a = noise(23, 17, 1), b = noise(23, 17, 2);
  const std::vector<std::uint8_t> none(a.pixels()), wrong(7);
  EXPECT_TRUE(std::isnan(mean_squared_error(a, b, none)));
  EXPECT_TRUE(std::isnan(ssim(a, b, 1, SsimOf::kLuminance, none)));
  EXPECT_THROW((void)mean_squared_error(a, b, wrong), ShapeError);
  EXPECT_THROW((void)ssim(a, b, 1, SsimOf::kLuminance, wrong), ShapeError);
}

}  // namespace
}  // namespace relumbre
