#include "relumbre/image/flip.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

Image noise(std::size_t width, std::size_t height, std::uint64_t seed, float amplitude = 1) {
  Image image = rgb_image(width, height);
  RandomStream random(seed);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float r = random.uniform(), g = random.uniform(), b = random.uniform();
    image.set_rgb(i, Rgb{r, g, b} * amplitude);
  }
  return image;
}

Image constant(std::size_t width, std::size_t height, const Rgb& value) {
  Image image = rgb_image(width, height);
  for (std::size_t i = 0; i < image.pixels(); ++i) image.set_rgb(i, value);
  return image;
}

/// Smooth colours with an edge, so that every part of the metric has something to see.
Image scene(std::size_t width, std::size_t height, double shift = 0) {
  Image image = rgb_image(width, height);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const double x = static_cast<double>(i % width) + shift, y = static_cast<double>(i / width);
    const double edge = x + 0.3 * y > 0.6 * static_cast<double>(width) ? 0.35 : 0;
    const auto wave = [&](double fx, double fy) {
      return static_cast<float>(0.3 + 0.25 * std::sin(fx * x + fy * y) + edge);
    };
    image.set_rgb(i, {wave(0.4, 0.1), wave(0.1, 0.5), wave(0.25, -0.3)});
  }
  return image;
}

// The slow twin: two-dimensional filters in double precision, straight from the papers.
namespace twin {

using Color = std::array<double, 3>;
using Colors = std::vector<Color>;

double decode(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }

constexpr double kM[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                             {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                             {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
constexpr double kInverse[3][3] = {{3.241003275, -1.537398934, -0.498615861},
                                   {-0.969224334, 1.875930071, 0.041554224},
                                   {0.055639423, -0.204011202, 1.057148933}};
constexpr Color kWhite{0.950428545, 1, 1.088900371};

Color times(const double (&m)[3][3], const Color& c) {
  Color r{};
  for (int i = 0; i < 3; ++i) r[i] = m[i][0] * c[0] + m[i][1] * c[1] + m[i][2] * c[2];
  return r;
}

Color ycxcz(const Color& linear) {
  const Color xyz = times(kM, linear);
  const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Color back(const Color& c) {
  const double y = (c[0] + 16) / 116, x = y + c[1] / 500, z = y - c[2] / 200;
  return times(kInverse, {x * kWhite[0], y * kWhite[1], z * kWhite[2]});
}

Color hunt_lab(const Color& linear) {
  const Color xyz = times(kM, linear);
  Color f{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = xyz[i] / kWhite[i], d = 6.0 / 29;
    f[i] = t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
  }
  const double l = 116 * f[1] - 16;
  return {l, 0.01 * l * 500 * (f[0] - f[1]), 0.01 * l * 200 * (f[1] - f[2])};
}

double hyab(const Color& a, const Color& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

struct Filter {
  int radius;
  std::vector<double> weights;  // (2 r + 1)², rows
  double& at(int x, int y) {
    return weights[static_cast<std::size_t>((y + radius) * (2 * radius + 1) + x + radius)];
  }
};

template <class Weight>
Filter filter(int radius, Weight&& weight) {
  Filter f{radius,
           std::vector<double>(static_cast<std::size_t>((2 * radius + 1) * (2 * radius + 1)))};
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) f.at(x, y) = weight(x, y);
  return f;
}

Filter sensitivity(double ppd, double a1, double b1, double a2, double b2) {
  const double pi = std::numbers::pi;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * ppd));
  Filter f = filter(radius, [&](int x, int y) {
    const double d2 = (x * x + y * y) / (ppd * ppd);
    return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * d2 / b1) +
           a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * d2 / b2);
  });
  double sum = 0;
  for (const double w : f.weights) sum += w;
  for (double& w : f.weights) w /= sum;
  return f;
}

Filter detector(double ppd, bool edge, bool vertical) {
  const double sd = 0.5 * 0.082 * ppd;
  Filter f = filter(static_cast<int>(std::ceil(3 * sd)), [&](int x, int y) {
    const double along = vertical ? y : x, g = std::exp(-(x * x + y * y) / (2 * sd * sd));
    return edge ? -along * g : (along * along / (sd * sd) - 1) * g;
  });
  double up = 0, down = 0;
  for (const double w : f.weights) (w > 0 ? up : down) += std::abs(w);
  for (double& w : f.weights) w /= w > 0 ? up : down;
  return f;
}

double apply(Filter& f, const Colors& plane, std::size_t c, int w, int h, int x, int y) {
  double sum = 0;
  for (int j = -f.radius; j <= f.radius; ++j)
    for (int i = -f.radius; i <= f.radius; ++i)
      sum += f.at(i, j) * plane[static_cast<std::size_t>(std::clamp(y + j, 0, h - 1) * w +
                                                         std::clamp(x + i, 0, w - 1))][c];
  return sum;
}

std::vector<double> flip(const Image& a, const Image& b, double ppd) {
  const int w = static_cast<int>(a.width()), h = static_cast<int>(a.height());
  std::array<Filter, 3> csf{sensitivity(ppd, 1, 0.0047, 0, 1), sensitivity(ppd, 1, 0.0053, 0, 1),
                            sensitivity(ppd, 34.1, 0.04, 13.5, 0.025)};
  Filter ex = detector(ppd, true, false), ey = detector(ppd, true, true);
  Filter px = detector(ppd, false, false), py = detector(ppd, false, true);
  std::array<Colors, 2> opponent;
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    std::size_t which = 0;
    for (const Image* image : {&a, &b}) {
      const Vec3d c(image->rgb(i));
      opponent[which++].push_back(ycxcz({decode(c.x), decode(c.y), decode(c.z)}));
    }
  }
  const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
  std::vector<double> error;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      std::array<Color, 2> lab;
      std::array<double, 2> edge, point;
      for (std::size_t k = 0; k < 2; ++k) {
        Color filtered{};
        for (std::size_t c = 0; c < 3; ++c) filtered[c] = apply(csf[c], opponent[k], c, w, h, x, y);
        Color rgb = back(filtered);
        for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
        lab[k] = hunt_lab(rgb);
        const auto strength = [&](Filter& f, Filter& g) {
          return std::hypot(apply(f, opponent[k], 0, w, h, x, y),
                            apply(g, opponent[k], 0, w, h, x, y)) /
                 116;
        };
        edge[k] = strength(ex, ey), point[k] = strength(px, py);
      }
      const double e = std::pow(hyab(lab[0], lab[1]), 0.7), bend = 0.4 * largest;
      const double color = e < bend ? 0.95 / bend * e : 0.95 + 0.05 * (e - bend) / (largest - bend);
      const double feature = std::sqrt(
          std::max(std::abs(edge[0] - edge[1]), std::abs(point[0] - point[1])) / std::sqrt(2.0));
      error.push_back(std::pow(color, 1 - feature));
    }
  return error;
}

}  // namespace twin

void expect_like_twin(const Image& a, const Image& b, double ppd, double tolerance) {
  const std::vector<float> fast = flip_ldr(a, b, {ppd});
  const std::vector<double> slow = twin::flip(a, b, ppd);
  ASSERT_EQ(fast.size(), slow.size());
  double sum = 0;
  for (std::size_t i = 0; i < fast.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(fast[i]), slow[i], tolerance) << "pixel " << i;
    sum += slow[i];
  }
  EXPECT_NEAR(mean_error(fast), sum / static_cast<double>(slow.size()), 1e-5);
}

TEST(Flip, IsThePapersFormulaWithTwoDimensionalFilters) {
  expect_like_twin(noise(31, 23, 1), noise(31, 23, 2), pixels_per_degree(), 5e-4);
  expect_like_twin(scene(41, 19), scene(41, 19, 1.5), pixels_per_degree(), 5e-4);
}

TEST(Flip, FiltersFollowThePixelsPerDegree) {
  for (const double ppd : {1.0, 13.7, 30.0}) {
    expect_like_twin(scene(17, 13), scene(17, 13, 2), ppd, 5e-4);
  }
}

TEST(Flip, HoldsOnImagesOfOneRowOrColumn) {
  for (const auto& [w, h] : {std::pair<std::size_t, std::size_t>{1, 1}, {1, 29}, {29, 1}}) {
    expect_like_twin(noise(w, h, 3), noise(w, h, 4), 20, 5e-4);
  }
}

TEST(Flip, ThePapersScreenHas67PixelsPerDegree) {
  EXPECT_NEAR(pixels_per_degree(), 67.0206, 1e-4);
  EXPECT_DOUBLE_EQ(FlipConfig{}.pixels_per_degree, pixels_per_degree());
  EXPECT_DOUBLE_EQ(pixels_per_degree(1.4), 2 * pixels_per_degree());
  EXPECT_THROW((void)pixels_per_degree(0), ValueError);
}

TEST(Flip, IdenticalImagesHaveNoError) {
  const Image a = scene(37, 29);
  EXPECT_EQ(mean_error(flip_ldr(a, a)), 0);
  const HdrFlip hdr = flip_hdr(a, a);
  EXPECT_EQ(mean_error(hdr.error), 0);
}

TEST(Flip, IsSymmetricBetweenDisplayedImages) {
  const Image a = noise(37, 29, 5), b = scene(37, 29);
  EXPECT_EQ(flip_ldr(a, b), flip_ldr(b, a));
}

TEST(Flip, StaysBetweenZeroAndOne) {
  const std::array<Rgb, 5> corners{{{0, 0, 0}, {1, 1, 1}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}}};
  for (const Rgb& a : corners) {
    for (const Rgb& b : corners) {
      for (const float e : flip_ldr(constant(5, 4, a), constant(5, 4, b))) {
        EXPECT_GE(e, 0);
        EXPECT_LE(e, 1);
        EXPECT_EQ(e > 0, a != b);
      }
    }
  }
}

TEST(Flip, GreenAgainstBlueIsTheLargestError) {
  EXPECT_NEAR(mean_error(flip_ldr(constant(3, 3, {0, 1, 0}), constant(3, 3, {0, 0, 1}))), 1, 1e-5);
}

TEST(Flip, GrowsWithTheError) {
  const Image a = constant(20, 20, Rgb(0.5F));
  double last = 0;
  for (const float value : {0.51F, 0.55F, 0.6F, 0.8F, 1.0F}) {
    const double error = mean_error(flip_ldr(a, constant(20, 20, Rgb(value))));
    EXPECT_GT(error, last);
    last = error;
  }
}

TEST(Flip, AnErrorIsFeltOnlyAroundIt) {
  const Image a = scene(80, 40);
  Image b = a;
  b.set_rgb(20 * 80 + 15, {1, 0, 0});
  const std::vector<float> error = flip_ldr(a, b);
  EXPECT_GT(error[20 * 80 + 15], 0.1F);
  EXPECT_EQ(error[20 * 80 + 60], 0);
}

TEST(Flip, ExposuresShowTheBrightestAndTheMedianPixelAt85Percent) {
  Image a = constant(5, 3, Rgb(0.5F));
  a.set_rgb(7, Rgb(16.0F));
  const ExposureRange range = flip_exposures(a);
  EXPECT_NEAR(range.stop - range.start, 5, 1e-5);
  EXPECT_EQ(range.count, 5U);
  // The curve's value where the start exposure puts the brightest pixel.
  const double x = 16 * std::exp2(range.start) * 0.6;
  EXPECT_NEAR((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.85, 1e-5);
}

TEST(Flip, AnEvenNumberOfPixelsHasTheMeanOfTheMiddleTwoAsMedian) {
  Image a = rgb_image(2, 2);
  const std::array<float, 4> values{1, 2, 4, 8};
  for (std::size_t i = 0; i < 4; ++i) a.set_rgb(i, Rgb(values[i]));
  const ExposureRange range = flip_exposures(a);
  EXPECT_NEAR(range.stop - range.start, std::log2(8.0 / 3), 1e-5);
  EXPECT_EQ(range.count, 2U);
}

TEST(Flip, ABrighterPairHasTheSameHdrErrorAtShiftedExposures) {
  const Image a = scene(33, 21), b = scene(33, 21, 1);
  Image a8 = a, b8 = b;
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    a8.set_rgb(i, a.rgb(i) * 8.0F);
    b8.set_rgb(i, b.rgb(i) * 8.0F);
  }
  const HdrFlip one = flip_hdr(a, b), eight = flip_hdr(a8, b8);
  EXPECT_NEAR(eight.exposures.start, one.exposures.start - 3, 1e-5);
  EXPECT_EQ(eight.exposures.count, one.exposures.count);
  EXPECT_NEAR(mean_error(eight.error), mean_error(one.error), 1e-5);
  EXPECT_GT(mean_error(one.error), 0.01);
}

TEST(Flip, HdrErrorIsTheLargestOverTheExposures) {
  Image a = scene(33, 21);
  a.set_rgb(40, Rgb(20.0F));
  const Image b = scene(33, 21, 1);
  const HdrFlip hdr = flip_hdr(a, b);
  ASSERT_GT(hdr.exposures.count, 3U);
  const auto shown = [&](const Image& image, double stops) {
    Image result = image;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      Rgb c = image.rgb(i) * static_cast<float>(0.6 * std::exp2(stops));
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = static_cast<double>(c[k]);
        const double y = std::min(1.0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
        c[k] =
            static_cast<float>(y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055);
      }
      result.set_rgb(i, c);
    }
    return result;
  };
  std::vector<float> largest(a.pixels(), 0.0F);
  const auto& range = hdr.exposures;
  for (std::size_t e = 0; e < range.count; ++e) {
    const double stops = range.start + (range.stop - range.start) * static_cast<double>(e) /
                                           static_cast<double>(range.count - 1);
    const std::vector<float> error = flip_ldr(shown(a, stops), shown(b, stops));
    for (std::size_t i = 0; i < error.size(); ++i) largest[i] = std::max(largest[i], error[i]);
  }
  for (std::size_t i = 0; i < largest.size(); ++i) EXPECT_NEAR(hdr.error[i], largest[i], 2e-3F);
  EXPECT_NEAR(mean_error(hdr.error), mean_error(largest), 2e-5);
}

TEST(Flip, SurvivesBlackInfiniteAndNegativeValues) {
  const Image black = constant(9, 7, Rgb{});
  EXPECT_EQ(mean_error(flip_hdr(black, black).error), 0);
  Image odd = constant(9, 7, Rgb(0.2F));
  odd.set_rgb(0, Rgb(std::numeric_limits<float>::infinity()));
  odd.set_rgb(1, Rgb(-3.0F));
  odd.set_rgb(2, Rgb(1e30F));
  for (const float e : flip_hdr(black, odd).error) EXPECT_TRUE(e >= 0 && e <= 1);
  for (const float e : flip_hdr(odd, black).error) EXPECT_TRUE(e >= 0 && e <= 1);
}

TEST(Flip, ANanIsKept) {
  Image a = constant(60, 4, Rgb(0.2F));
  a.set_rgb(3, Rgb(std::numeric_limits<float>::quiet_NaN()));
  const Image b = constant(60, 4, Rgb(0.3F));
  for (const auto& error : {flip_ldr(a, b), flip_hdr(b, a).error}) {
    EXPECT_TRUE(std::isnan(error[3]));
    EXPECT_FALSE(std::isnan(error[50]));
  }
}

TEST(Flip, AMaskRestrictsTheMean) {
  const std::vector<float> error{0.1F, 0.2F, 0.4F};
  EXPECT_NEAR(mean_error(error, std::vector<std::uint8_t>{1, 0, 1}), 0.25, 1e-7);
  EXPECT_TRUE(std::isnan(mean_error(error, std::vector<std::uint8_t>{0, 0, 0})));
  EXPECT_THROW((void)mean_error(error, std::vector<std::uint8_t>{1}), ShapeError);
}

TEST(Flip, PicturesRunFromBlackToPaleYellow) {
  const std::vector<float> error{0, 1, std::numeric_limits<float>::quiet_NaN(), 7, 60.0F / 255};
  const std::vector<std::uint8_t> expected{0, 0,   4,   252, 253, 191, 0,  0,
                                           4, 252, 253, 191, 74,  16,  121};
  EXPECT_EQ(error_picture(error), expected);
}

TEST(Flip, IsTheSameForAnyNumberOfThreads) {
  const Image a = noise(50, 41, 7), b = noise(50, 41, 8);
  const auto with = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return flip_ldr(a, b);
  };
  EXPECT_EQ(with(1), with(3));
}

TEST(Flip, RefusesWhatItCannotCompare) {
  EXPECT_THROW((void)flip_ldr(noise(3, 4, 1), noise(4, 3, 1)), ShapeError);
  EXPECT_THROW((void)flip_hdr(Image(), Image()), ShapeError);
  const std::vector<std::string> names{"R", "G"};
  EXPECT_THROW((void)flip_ldr(Image(3, 3, names), Image(3, 3, names)), ValueError);
  for (const double ppd : {0.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW((void)flip_ldr(noise(3, 4, 1), noise(3, 4, 1), {ppd}), ValueError) << ppd;
  }
}

}  // namespace
}  // namespace relumbre
