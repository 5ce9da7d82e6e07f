#include "relumbre/sat/box_filter.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/sat/test_images.h"

namespace relumbre {
namespace {

constexpr Border kBorders[] = {Border::kClamp, Border::kConstant, Border::kMirror};

/// Pixel i of an axis as the border mode continues it; size where a constant stands.
std::size_t continued(std::ptrdiff_t i, std::size_t size, Border mode) {
  const auto n = static_cast<std::ptrdiff_t>(size);
  if (mode == Border::kClamp)
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, n - 1));
  if (mode == Border::kConstant) return i < 0 || i >= n ? size : static_cast<std::size_t>(i);
  const std::ptrdiff_t at = ((i % (2 * n)) + 2 * n) % (2 * n);
  return static_cast<std::size_t>(at < n ? at : 2 * n - 1 - at);
}

/// How much of pixel i lies in [low, high].
double part(std::ptrdiff_t i, double low, double high) {
  const auto x = static_cast<double>(i);
  return std::max(0.0, std::min(high, x + 1) - std::max(low, x));
}

/// The mean over a rectangle of the padded image, pixel by pixel.
double brute_mean(const PixelView& image, std::size_t c, double x0, double y0, double x1, double y1,
                  const BorderRule& border) {
  double total = 0;
  const auto first = [](double v) { return static_cast<std::ptrdiff_t>(std::floor(v)); };
  for (std::ptrdiff_t y = first(y0); static_cast<double>(y) < y1; ++y) {
    for (std::ptrdiff_t x = first(x0); static_cast<double>(x) < x1; ++x) {
      const std::size_t px = continued(x, image.width, border.mode);
      const std::size_t py = continued(y, image.height, border.mode);
      const bool beyond = px == image.width || py == image.height;
      const float value =
          beyond ? border.value[c] : image.values[(py * image.width + px) * image.channels + c];
      total += part(x, x0, x1) * part(y, y0, y1) * double{value};
    }
  }
  return total / ((x1 - x0) * (y1 - y0));
}

TEST(BoxMean, MatchesThePaddedImageAtAllBordersAndFractions) {
  const auto pixels = noise_image(9 * 6 * 2, 4);
  const PixelView image{pixels, 9, 6, 2};
  const auto table = SummedAreaTable::build(pixels, 9, 6, 2);
  RandomStream random(7);
  for (const Border mode : kBorders) {
    const BorderRule border{mode, {0.5F, -2}};
    for (int i = 0; i < 2000; ++i) {
      const auto coordinate = [&] { return std::round((random.uniform() * 80 - 30) * 8) / 8; };
      const double x0 = double{coordinate()}, y0 = double{coordinate()};
      const double x1 = x0 + 0.125 + double{std::abs(coordinate())};
      const double y1 = y0 + 0.125 + double{std::abs(coordinate())};
      const SatSums mean = table.box_mean(x0, y0, x1, y1, border);
      for (std::size_t c = 0; c < 2; ++c)
        ASSERT_NEAR(mean[c], brute_mean(image, c, x0, y0, x1, y1, border), 1e-9)
            << static_cast<int>(mode) << ": " << x0 << " " << y0 << " " << x1 << " " << y1;
    }
  }
}

TEST(BoxMean, MatchesASupersampledImage) {
  const auto pixels = noise_image(12 * 10, 6);
  const auto table = SummedAreaTable::build(pixels, 12, 10, 1, {.kind = SatKind::kFloat64});
  const double x0 = 2.3, y0 = 1.7, x1 = 8.45, y1 = 6.05;
  constexpr int kSamples = 1500;
  double sum = 0;
  for (int j = 0; j < kSamples; ++j) {
    for (int i = 0; i < kSamples; ++i) {
      const auto x = static_cast<std::size_t>(x0 + (x1 - x0) * (i + 0.5) / kSamples);
      const auto y = static_cast<std::size_t>(y0 + (y1 - y0) * (j + 0.5) / kSamples);
      sum += double{pixels[y * 12 + x]};
    }
  }
  EXPECT_NEAR(table.box_mean(x0, y0, x1, y1)[0], sum / kSamples / kSamples, 5e-4);
}

TEST(BoxFilter, MatchesBruteForceForEveryKindBorderAndRadius) {
  const auto pixels = noise_image(23 * 14 * 3, 2);
  const PixelView image{pixels, 23, 14, 3};
  for (const SatKind kind : kSatKinds) {
    for (const Border mode : kBorders) {
      for (const double radius : {0.0, 0.3, 1.0, 2.75, 7.0, 40.5}) {
        BoxFilterConfig config;
        config.kind = kind, config.border = {mode, {1, 2, 3}};
        const auto out = box_filter(image, radius, config);
        for (std::size_t i = 0; i < out.size(); i += 5) {
          const auto x = static_cast<double>(i / 3 % 23), y = static_cast<double>(i / 3 / 23);
          ASSERT_NEAR(double{out[i]},
                      brute_mean(image, i % 3, x - radius, y - radius, x + 1 + radius,
                                 y + 1 + radius, config.border),
                      2e-5)
              << sat_kind_name(kind) << " " << radius;
        }
      }
    }
  }
}

TEST(BoxFilter, RadiiPerPixelAreThoseOfTheWholeFilters) {
  const auto pixels = noise_image(31 * 20 * 4, 8);
  std::vector<float> radii = noise_image(31 * 20, 9, 0, 6);
  SatConfig sat;
  sat.kind = SatKind::kFixed32;
  const auto table = SummedAreaTable::build(pixels, 31, 20, 4, sat);
  std::vector<float> varying(pixels.size()), uniform(pixels.size());
  box_filter(table, radii, {}, varying);
  for (std::size_t i = 0; i < radii.size(); i += 41) {
    box_filter(table, double{radii[i]}, {}, uniform);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(varying[4 * i + c], uniform[4 * i + c]);
  }
}

TEST(BoxFilter, ConstantImageStaysConstant) {
  const std::vector<float> pixels(40 * 30 * 2, 0.7F);
  for (const SatKind kind : {SatKind::kFixed64, SatKind::kFloat64, SatKind::kFloat32Centred}) {
    for (const Border mode : {Border::kClamp, Border::kMirror}) {
      for (const double radius : {0.0, 1.0, 3.3, 100.0}) {
        BoxFilterConfig config;
        config.kind = kind, config.border.mode = mode;
        for (const float v : box_filter({pixels, 40, 30, 2}, radius, config))
          ASSERT_NEAR(v, 0.7F, 1e-7F);
      }
    }
  }
}

TEST(BoxFilter, IsTheSameWhateverTheNumberOfThreads) {
  const auto pixels = noise_image(300 * 40, 8);
  std::vector<float> first;
  for (const std::size_t threads : {1, 2, 3, 8}) {
    const ThreadLimit limit(threads);
    const auto out = box_filter({pixels, 300, 40, 1}, 2.5, {.kind = SatKind::kFloat32});
    if (first.empty()) first = out;
    EXPECT_EQ(out, first);
  }
}

/// Variance along x of what a filter makes of one bright pixel.
double measured_variance(const std::vector<float>& image, std::size_t size) {
  double sum = 0, second = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double x = static_cast<double>(i % size) - static_cast<double>(size / 2);
    sum += double{image[i]}, second += double{image[i]} * x * x;
  }
  return second / sum;
}

TEST(IteratedBox, HasExactlyTheVarianceAsked) {
  constexpr std::size_t kSize = 101;
  std::vector<float> impulse(kSize * kSize, 0);
  impulse[kSize * (kSize / 2) + kSize / 2] = 1;
  for (const int passes : {1, 2, 3, 5}) {
    for (const double sigma : {0.3, 0.5, 1.0, 2.2, 4.7}) {
      const double radius = iterated_box_radius(sigma, passes);
      EXPECT_NEAR(passes * box_variance(radius), sigma * sigma, 1e-12);
      const auto blurred = iterated_box_filter({impulse, kSize, kSize, 1}, sigma, passes);
      EXPECT_NEAR(measured_variance(blurred, kSize), sigma * sigma, 1e-5 * (1 + sigma * sigma));
    }
  }
}

TEST(IteratedBox, IsNearTheGaussian) {
  constexpr std::size_t kSize = 65;
  constexpr double kSigma = 4;
  std::vector<float> impulse(kSize * kSize, 0);
  impulse[kSize * (kSize / 2) + kSize / 2] = 1;
  const auto blurred = iterated_box_filter({impulse, kSize, kSize, 1}, kSigma, 4);
  const double peak = 1 / (2 * std::numbers::pi * kSigma * kSigma);
  for (std::size_t i = 0; i < impulse.size(); ++i) {
    const double x = static_cast<double>(i % kSize) - 32, y = static_cast<double>(i / kSize) - 32;
    const double gaussian = peak * std::exp(-(x * x + y * y) / (2 * kSigma * kSigma));
    EXPECT_NEAR(double{blurred[i]}, gaussian, 0.075 * peak);
  }
}

TEST(BoxFilter, RefusesBadRadii) {
  const auto pixels = noise_image(6 * 4, 1);
  const PixelView image{pixels, 6, 4, 1};
  for (const double bad : {-0.5, std::nan(""), 1e9, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(box_filter(image, bad), ValueError);
    EXPECT_THROW(iterated_box_filter(image, bad), ValueError);
    const std::vector<float> radii(24, static_cast<float>(bad));
    EXPECT_THROW(box_filter(image, radii), ValueError);
  }
  EXPECT_THROW(iterated_box_filter(image, 1, 0), ValueError);
  EXPECT_THROW(box_filter(image, std::vector<float>(23, 1.0F)), ShapeError);
  EXPECT_THROW(box_filter({pixels, 6, 5, 1}, 1.0), ShapeError);
  const std::vector<float> none;
  EXPECT_TRUE(box_filter({none, 0, 0, 3}, 1.0).empty());
}

TEST(BoxFilter, RefusesARadiusBeyondTheTablesLargestBox) {
  const auto pixels = noise_image(60 * 40, 1);
  SatConfig sat;
  sat.kind = SatKind::kFixed32, sat.largest_box = 9;
  const auto table = SummedAreaTable::build(pixels, 60, 40, 1, sat);
  std::vector<float> out(pixels.size());
  EXPECT_NO_THROW(box_filter(table, 1.0, {}, out));
  EXPECT_THROW(box_filter(table, 1.1, {}, out), ValueError);
}

}  // namespace
}  // namespace relumbre
