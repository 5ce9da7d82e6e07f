#include "relumbre/image/metrics.h"

#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Image noise(std::size_t width, std::size_t height, std::uint64_t seed, float amplitude = 1) {
  Image image = rgb_image(width, height);
  RandomStream random(seed);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float r = random.uniform(), g = random.uniform(), b = random.uniform();
    image.set_rgb(i, Rgb{r, g, b} * amplitude);
  }
  return image;
}

Image constant(std::size_t width, std::size_t height, float value) {
  Image image = rgb_image(width, height);
  for (std::size_t i = 0; i < image.pixels(); ++i) image.set_rgb(i, Rgb(value));
  return image;
}

TEST(Psnr, OfAKnownDifferenceIsByHand) {
  const Image a = constant(4, 3, 0.5F);
  Image b = a;
  b.set_rgb(5, {0.5F, 0.75F, 0.5F});  // one of 36 values differs by 1/4
  EXPECT_DOUBLE_EQ(mean_squared_error(a, b), 1.0 / 16 / 36);
  EXPECT_DOUBLE_EQ(psnr(a, b), 10 * std::log10(16 * 36));
  EXPECT_DOUBLE_EQ(psnr(a, b, 10), psnr(a, b) + 20);
}

TEST(Psnr, IsInfiniteForEqualImages) {
  const Image a = noise(7, 5, 1);
  EXPECT_EQ(psnr(a, a), std::numeric_limits<double>::infinity());
}

TEST(Ssim, IsOneForEqualImagesAndSymmetric) {
  const Image a = noise(31, 17, 1), b = noise(31, 17, 2);
  for (const SsimOf of : {SsimOf::kLuminance, SsimOf::kRgbMean}) {
    EXPECT_NEAR(ssim(a, a, 1, of), 1, 1e-12);
    EXPECT_NEAR(ssim(a, b, 1, of), ssim(b, a, 1, of), 1e-12);
    EXPECT_LT(ssim(a, b, 1, of), 0.5);
  }
}

TEST(Ssim, OfConstantImagesIsTheLuminanceTerm) {
  const double p = 0.25, q = 0.75, c1 = 1e-4;
  const double expected = (2 * p * q + c1) / (p * p + q * q + c1);
  EXPECT_NEAR(ssim(constant(20, 12, 0.25F), constant(20, 12, 0.75F)), expected, 1e-6);
}

TEST(Ssim, ScalesWithThePeak) {
  const Image a = noise(20, 20, 1), b = noise(20, 20, 2);
  const Image a255 = noise(20, 20, 1, 255), b255 = noise(20, 20, 2, 255);
  EXPECT_NEAR(ssim(a, b), ssim(a255, b255, 255), 1e-5);
}

/// Wang et al. 2004 as written: every window summed on its own, two-pass variances.
double brute_force_window(const Image& a, const Image& b, std::string_view name, std::size_t x0,
                          std::size_t y0, double peak) {
  double total = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
  const auto for_each = [&](auto&& body) {
    for (std::size_t j = 0; j < 11; ++j) {
      for (std::size_t i = 0; i < 11; ++i) {
        const double dx = static_cast<double>(i) - 5, dy = static_cast<double>(j) - 5;
        const std::size_t at = (y0 + j) * a.width() + x0 + i;
        body(std::exp(-(dx * dx + dy * dy) / 4.5), double{a.channel(name)[at]},
             double{b.channel(name)[at]});
      }
    }
  };
  for_each([&](double w, double p, double q) { total += w, ma += w * p, mb += w * q; });
  ma /= total, mb /= total;
  for_each([&](double w, double p, double q) {
    va += w * (p - ma) * (p - ma), vb += w * (q - mb) * (q - mb), cov += w * (p - ma) * (q - mb);
  });
  va /= total, vb /= total, cov /= total;
  const double c1 = std::pow(0.01 * peak, 2), c2 = std::pow(0.03 * peak, 2);
  return (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

double brute_force_rgb(const Image& a, const Image& b, double peak) {
  double sum = 0;
  std::size_t count = 0;
  for (const char* name : {"R", "G", "B"}) {
    for (std::size_t y = 0; y + 11 <= a.height(); ++y) {
      for (std::size_t x = 0; x + 11 <= a.width(); ++x, ++count) {
        sum += brute_force_window(a, b, name, x, y, peak);
      }
    }
  }
  return sum / static_cast<double>(count);
}

TEST(Ssim, MatchesBruteForce) {
  for (const auto& [w, h] : {std::array{11UL, 11UL}, {12UL, 29UL}, {31UL, 13UL}, {23UL, 37UL}}) {
    const Image a = noise(w, h, 1), b = noise(w, h, 2);
    EXPECT_NEAR(ssim(a, b, 1.5, SsimOf::kRgbMean), brute_force_rgb(a, b, 1.5), 1e-10);
  }
}

TEST(Ssim, ThreadsDoNotChangeTheResult) {
  const Image a = noise(100, 90, 1), b = noise(100, 90, 2);
  const double all = ssim(a, b);
  const ThreadLimit one(1);
  EXPECT_EQ(ssim(a, b), all);
}

TEST(Metrics, ShapesMustAgree) {
  const Image a = rgb_image(20, 30), b = rgb_image(30, 20);
  EXPECT_THAT([&] { (void)psnr(a, b); }, ThrowsMessage<ShapeError>(HasSubstr("20 x 30")));
  EXPECT_THROW((void)ssim(a, b), ShapeError);
  EXPECT_THROW((void)difference_image(a, b), ShapeError);
  EXPECT_THROW((void)compare_tone_mapped(a, b), ShapeError);
  EXPECT_THROW((void)psnr(Image(), Image()), ShapeError);
  EXPECT_THAT([] { (void)ssim(rgb_image(10, 50), rgb_image(10, 50)); },
              ThrowsMessage<ShapeError>(HasSubstr("at least 11")));
}

TEST(Metrics, MissingChannelsAndImpossiblePeaksAreRefused) {
  const std::vector<std::string> names = {"Z"};
  const Image z(20, 20, names), a = rgb_image(20, 20);
  EXPECT_THROW((void)psnr(a, z), ValueError);
  EXPECT_THROW((void)ssim(a, z), ValueError);
  EXPECT_THROW((void)psnr(a, a, 0), ValueError);
  EXPECT_THROW((void)ssim(a, a, std::nan("")), ValueError);
}

TEST(CompareImages, SmallImagesHaveNoSsim) {
  const ImageComparison c = compare_images(noise(5, 50, 1), noise(5, 50, 2));
  EXPECT_GT(c.mse, 0);
  EXPECT_TRUE(std::isnan(c.ssim_luminance) && std::isnan(c.ssim_rgb));
}

TEST(CompareToneMapped, IgnoresWhatClipsAndSharesTheReferencesExposure) {
  const ToneConfig tone{.auto_exposure = true};
  const Image a = noise(40, 40, 1, 5), twice = noise(40, 40, 1, 10);
  EXPECT_EQ(compare_tone_mapped(a, a, tone).mse, 0);
  EXPECT_GT(compare_tone_mapped(a, twice, tone).mse, 1e-3);
  Image lamp = a, brighter = a;
  lamp.set_rgb(0, Rgb(1e4F)), brighter.set_rgb(0, Rgb(1e6F));
  EXPECT_NEAR(compare_tone_mapped(lamp, brighter).mse, 0, 1e-9);
}

TEST(DifferenceImage, IsTheAbsoluteDifference) {
  Image a = rgb_image(2, 1), b = rgb_image(2, 1);
  a.set_rgb(1, {1, 2, 3});
  b.set_rgb(1, {2, 2, 1});
  EXPECT_EQ(difference_image(a, b).rgb(1), (Rgb{1, 0, 2}));
  EXPECT_EQ(difference_image(a, b).rgb(0), Rgb{});
}

}  // namespace
}  // namespace relumbre
