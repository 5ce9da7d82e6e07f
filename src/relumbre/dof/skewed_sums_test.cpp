#include "relumbre/dof/skewed_sums.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"
#include "relumbre/dof/spread_sums.h"

namespace relumbre {
namespace {

constexpr std::size_t kWidth = 97, kHeight = 83, kFirst = 10, kLast = 70;
constexpr double kLargest = 90;

const std::vector<Aperture> kPolygons{
    {.blades = 6}, {.blades = 8}, {.blades = 8, .rotation_deg = 22.5}, {.blades = 4}};

/// What the stripe's sums are after `fragments`.
template <class Sums>
std::vector<OpaqueSum> sums_of(Sums sums, const std::vector<Fragment>& fragments) {
  std::vector<OpaqueSum> result(kWidth * (kLast - kFirst));
  sums.clear(static_cast<float>(kLargest));
  for (const Fragment& fragment : fragments) sums.spread(fragment);
  sums.integrate([&](std::size_t y, std::size_t left, std::size_t right, const OpaqueSum* row) {
    std::copy(row + left, row + right,
              result.begin() + static_cast<std::ptrdiff_t>(y * kWidth + left));
  });
  return result;
}

/// One outline by skewed scans, and row by row.
template <bool kUpright>
struct Twins {
  BlurShape shape;
  Aperture aperture;
  ApertureKernels kernels{shape, aperture, kLargest};
  SkewedOutline outline = *skewed_outline(outline_corners(shape, aperture));

  [[nodiscard]] std::vector<OpaqueSum> fast(const std::vector<Fragment>& fragments) const {
    return sums_of(SkewedSums<OpaqueSum, kUpright>(outline, kWidth, kHeight, kFirst, kLast),
                   fragments);
  }
  [[nodiscard]] std::vector<OpaqueSum> slow(const std::vector<Fragment>& fragments) const {
    return sums_of(SpreadSums<OpaqueSum>(kernels, kWidth, kHeight, kFirst, kLast), fragments);
  }
};

/// A diameter that a kernel is made for exactly: 1/64 of a pixel, or of the power of 2 below / 256.
float exact(double diameter) {
  const double size = std::abs(diameter);
  const double step = size <= 4 ? 1.0 / 64 : std::exp2(std::floor(std::log2(size))) / 256;
  return static_cast<float>(std::round(diameter / step) * step);
}

std::vector<Fragment> scattered(int count, double least, bool sloped) {
  std::vector<Fragment> fragments;
  RandomStream random(5);
  for (int i = 0; i < count; ++i) {
    Fragment fragment{.x = static_cast<std::uint32_t>(random.uniform() * kWidth),
                      .y = static_cast<std::uint32_t>(random.uniform() * kHeight),
                      .color = {random.uniform(), random.uniform(), random.uniform(), 1}};
    const double sign = random.uniform() < 0.5F ? -1 : 1;
    fragment.coc = exact(least + (kLargest - least) *
                                     static_cast<double>(random.uniform() * random.uniform())) *
                   static_cast<float>(sign);
    if (sloped) fragment.slope = {random.uniform() - 0.5F, random.uniform() - 0.5F};
    fragments.push_back(fragment);
  }
  return fragments;
}

TEST(SkewedSums, ABoxIsTheBoxByRows) {
  const Twins<true> twins{.shape = BlurShape::kBox, .aperture = {}};
  const std::vector<Fragment> fragments = scattered(500, 0, false);
  const auto fast = twins.fast(fragments), slow = twins.slow(fragments);
  for (std::size_t i = 0; i < fast.size(); ++i)
    for (int lane = 0; lane < 4; ++lane)
      ASSERT_NEAR(fast[i].lane[lane], slow[i].lane[lane], 1e-5) << i % kWidth << "," << i / kWidth;
}

/// One blur alone, with nothing else in the rows that it passes through: all of the stripe's, too.
template <bool kUpright>
void expect_whole(const Twins<kUpright>& twins, double tolerance) {
  for (const std::uint32_t y : {2U, 12U, 40U, 68U, 81U}) {
    for (const float diameter : {30.0F, -56.0F, 88.0F}) {
      const std::vector<Fragment> one{{.x = 48, .y = y, .coc = diameter, .color = {1, 1, 1, 1}}};
      const auto fast = twins.fast(one), slow = twins.slow(one);
      for (std::size_t row = 0; row < kLast - kFirst; ++row) {
        double sum = 0, expected = 0;
        for (std::size_t x = 0; x < kWidth; ++x) {
          sum += fast[row * kWidth + x].weight();
          expected += slow[row * kWidth + x].weight();
        }
        EXPECT_NEAR(sum, expected, tolerance / std::abs(static_cast<double>(diameter)))
            << "at " << y << ", " << diameter << " wide: row " << row;
      }
    }
  }
}

TEST(SkewedSums, ABlurAloneIsInAllOfItsRows) {
  expect_whole(Twins<true>{.shape = BlurShape::kBox, .aperture = {}}, 1e-4);
  for (const Aperture& aperture : kPolygons)
    expect_whole(Twins<false>{.shape = BlurShape::kAperture, .aperture = aperture}, 0.1);
}

/// A sum that counts how often something is added to any.
struct CountedSum : OpaqueSum {
  static inline std::size_t additions = 0;

  using OpaqueSum::OpaqueSum;
  void add(const CountedSum& other, double scale) {
    ++additions;
    OpaqueSum::add(other, scale);
  }
  void add(const CountedSum& other) {
    ++additions;
    OpaqueSum::add(other);
  }
};

/// What one more fragment beside an equal one adds to the additions of spreading and of sweeping.
template <class Sums>
std::size_t additions_a_fragment(Sums& sums, float diameter) {
  const Fragment fragment{.x = 48, .y = 40, .coc = diameter, .color = {1, 1, 1, 1}};
  const auto additions = [&](int fragments) {
    CountedSum::additions = 0;
    sums.clear(static_cast<float>(kLargest));
    for (int i = 0; i < fragments; ++i) sums.spread(fragment);
    sums.integrate([](auto&&...) {});
    return CountedSum::additions;
  };
  return additions(2) - additions(1);
}

/// Expects the same for every size of blur.
template <bool kUpright>
void expect_constant_work(const Twins<kUpright>& twins) {
  SkewedSums<CountedSum, kUpright> fast(twins.outline, kWidth, kHeight, kFirst, kLast);
  const std::size_t small = additions_a_fragment(fast, 8);
  EXPECT_GT(small, 0U);
  for (const float diameter : {11.3F, 16.0F, 23.7F, 32.0F, 48.0F})
    EXPECT_LE(additions_a_fragment(fast, diameter), small) << diameter;
  SpreadSums<CountedSum> by_rows(twins.kernels, kWidth, kHeight, kFirst, kLast);
  EXPECT_GT(additions_a_fragment(by_rows, 48), 3 * additions_a_fragment(by_rows, 8));
}

TEST(SkewedSums, TheWorkOfAFragmentDoesNotGrowWithItsBlur) {
  expect_constant_work(Twins<true>{.shape = BlurShape::kBox, .aperture = {}});
  for (const Aperture& aperture : kPolygons)
    expect_constant_work(Twins<false>{.shape = BlurShape::kAperture, .aperture = aperture});
}

/// How far inside the polygon of this diameter a point is, pixels.
double depth_inside(const OutlineCorners& corners, double diameter, double x, double y) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double ex = b.x - a.x, ey = b.y - a.y;
    const double cross = ex * (y - a.y * diameter) - ey * (x - a.x * diameter);
    least = std::min(least, -cross / std::hypot(ex, ey));
  }
  return least;
}

TEST(SkewedSums, APointBecomesThePolygon) {
  constexpr std::uint32_t kX = 48, kY = 40;
  for (const Aperture& aperture : kPolygons) {
    const Twins<false> twins{.shape = BlurShape::kAperture, .aperture = aperture};
    const OutlineCorners corners = outline_corners(BlurShape::kAperture, aperture);
    for (const double diameter : {9.7, -9.7, 17.0, 31.31, -44.44}) {
      const auto sums = twins.fast(
          {{.x = kX, .y = kY, .coc = static_cast<float>(diameter), .color = {1, 0.5F, 0, 1}}});
      const double level =
          1 / (std::numbers::pi / 4 * diameter * diameter * aperture.open_fraction());
      double light = 0, right = 0, down = 0;
      for (std::size_t i = 0; i < sums.size(); ++i) {
        const double x = static_cast<double>(i % kWidth) - kX,
                     y = static_cast<double>(i / kWidth + kFirst) - kY;
        const double here = sums[i].lane[0];
        light += here, right += here * x, down += here * y;
        const double inside = depth_inside(corners, std::abs(diameter), x, y);
        if (std::abs(inside) < 1.8) {
          EXPECT_GE(here, -0.1 * level);
          EXPECT_LE(here, 1.1 * level);
        } else {
          EXPECT_NEAR(here, inside > 0 ? level : 0, 0.015 * level)
              << diameter << ": " << x << "," << y;
        }
        EXPECT_NEAR(sums[i].lane[1], here / 2, 1e-12);
      }
      EXPECT_NEAR(light, 1, 1e-9) << aperture.blades << " " << diameter;
      EXPECT_NEAR(right, 0, 0.03) << aperture.blades << " " << diameter;
      EXPECT_NEAR(down, 0, 0.03) << aperture.blades << " " << diameter;
    }
  }
}

/// Tilted, cut off and repeated at borders. Edges may differ; what they enclose, hardly.
TEST(SkewedSums, ManyPolygonsAreNearlyThoseByRows) {
  for (const Aperture& aperture : kPolygons) {
    const Twins<false> twins{.shape = BlurShape::kAperture, .aperture = aperture};
    const std::vector<Fragment> fragments = scattered(3000, 10, true);
    const auto fast = twins.fast(fragments), slow = twins.slow(fragments);
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < fast.size(); ++i) {
      difference += std::pow(fast[i].weight() - slow[i].weight(), 2);
      sum += std::pow(slow[i].weight(), 2);
    }
    EXPECT_LT(std::sqrt(difference / sum), 0.01) << aperture.blades;
  }
}

TEST(SkewedSums, AConstantPictureStaysConstant) {
  for (const Aperture& aperture : kPolygons) {
    const Twins<false> twins{.shape = BlurShape::kAperture, .aperture = aperture};
    for (const float diameter : {8.5F, -21.7F, 50.0F}) {
      std::vector<Fragment> fragments;
      for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x)
          fragments.push_back({.x = x, .y = y, .coc = diameter, .color = {1, 1, 1, 1}});
      for (const OpaqueSum& sum : twins.fast(fragments)) ASSERT_NEAR(sum.weight(), 1, 1e-9);
    }
  }
}

TEST(SkewedOutline, HexagonsAndOctagonsHaveFewSlopes) {
  const auto slopes = [](const Aperture& aperture) {
    return skewed_outline(outline_corners(BlurShape::kAperture, aperture)).value().slopes.size();
  };
  EXPECT_EQ(slopes({.blades = 6}), 2U);
  EXPECT_EQ(slopes({.blades = 8}), 4U);
  EXPECT_EQ(slopes({.blades = 8, .rotation_deg = 22.5}), 3U);
  EXPECT_TRUE(skewed_outline(outline_corners(BlurShape::kBox, {}))->upright());
}

TEST(SkewedOutline, DiscsAndSteepOrManySlopesAreLeftToRows) {
  for (const Aperture& aperture :
       {Aperture{}, {.blades = 16}, {.blades = 3}, {.blades = 6, .rotation_deg = 5}})
    EXPECT_FALSE(skewed_outline(outline_corners(BlurShape::kAperture, aperture)).has_value());
}

TEST(SkewedOutline, HasThePolygonsArea) {
  for (const Aperture& aperture : kPolygons) {
    const auto outline = skewed_outline(outline_corners(BlurShape::kAperture, aperture));
    ASSERT_TRUE(outline.has_value());
    const double area = std::numbers::pi / 4 * aperture.open_fraction();
    EXPECT_NEAR(outline->area, area, 1e-12);
  }
}

}  // namespace
}  // namespace relumbre
