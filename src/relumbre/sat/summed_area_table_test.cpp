#include "relumbre/sat/summed_area_table.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/sat/test_images.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SatConfig of_kind(SatKind kind) {
  SatConfig config;
  config.kind = kind;
  return config;
}

/// How far from the true sum of `pixels` values up to 1 a kind may be in a small image.
double tolerance(SatKind kind, const SummedAreaTable& table, std::size_t pixels) {
  if (is_fixed(kind)) return 0.5 * table.fixed_point().unit() * static_cast<double>(pixels) + 1e-12;
  return kind == SatKind::kFloat64 ? 1e-9 : 2e-3;
}

TEST(Sat, GivesThePapersGoldenValues) {
  // The sum up to and including the pixel in column 1, row 2.
  const std::vector<std::uint8_t> pixels = {2, 3, 9,  //
                                            2, 3, 9,  //
                                            0, 1, 9};
  const std::vector<float> reals(pixels.begin(), pixels.end());
  for (const SatKind kind : kSatKinds) {
    EXPECT_EQ(SummedAreaTable::build(pixels, 3, 3, 1, of_kind(kind)).box_sum(0, 0, 2, 3)[0], 11);
    EXPECT_NEAR(SummedAreaTable::build(reals, 3, 3, 1, of_kind(kind)).box_sum(0, 0, 2, 3)[0], 11,
                1e-5);
  }
}

TEST(Sat, BoxIsFourSumsAsInThePaper) {
  // Sums 2, 6, 8 and 28 at the corners: 28 − 8 − 6 + 2 = 16.
  const std::vector<std::uint8_t> pixels = {2, 6, 4, 16};
  const auto table = SummedAreaTable::build(pixels, 2, 2, 1, of_kind(SatKind::kFixed32));
  EXPECT_EQ(table.box_sum(0, 0, 2, 2)[0], 28);
  EXPECT_EQ(table.box_sum(0, 0, 2, 1)[0], 8);
  EXPECT_EQ(table.box_sum(0, 0, 1, 2)[0], 6);
  EXPECT_EQ(table.box_sum(0, 0, 1, 1)[0], 2);
  EXPECT_EQ(table.box_sum(1, 1, 2, 2)[0], 16);
}

TEST(Sat, EveryKindMatchesBruteForceForAllBoxes) {
  constexpr std::size_t kWidth = 19, kHeight = 5, kChannels = 3;
  const auto image = noise_image(kWidth * kHeight * kChannels, 5, -0.5F, 1);
  for (const SatKind kind : kSatKinds) {
    const auto table = SummedAreaTable::build(image, kWidth, kHeight, kChannels, of_kind(kind));
    for (std::size_t y0 = 0; y0 <= kHeight; ++y0) {
      for (std::size_t x0 = 0; x0 <= kWidth; ++x0) {
        SatSums sum{};
        for (std::size_t y1 = y0; y1 <= kHeight; ++y1) {
          sum = {};
          for (std::size_t x1 = x0; x1 <= kWidth; ++x1) {
            const SatSums box = table.box_sum(x0, y0, x1, y1);
            for (std::size_t c = 0; c < kChannels; ++c)
              ASSERT_NEAR(box[c], sum[c], tolerance(kind, table, (x1 - x0) * (y1 - y0)));
            for (std::size_t y = y0; x1 < kWidth && y < y1; ++y) {
              for (std::size_t c = 0; c < kChannels; ++c)
                sum[c] += double{image[(y * kWidth + x1) * kChannels + c]};
            }
          }
        }
      }
    }
  }
}

struct FixedCase {
  SatKind kind;
  std::size_t width, height, channels, box_side;
  float lowest, highest;
};

/// Sums of the quantised values, one by one.
std::int64_t brute_units(const std::vector<float>& image, const FixedCase& size, double scale,
                         std::size_t x0, std::size_t y0, std::size_t side, std::size_t c) {
  std::int64_t sum = 0;
  for (std::size_t y = y0; y < y0 + side; ++y) {
    for (std::size_t x = x0; x < x0 + side; ++x)
      sum += std::llrint(double{image[(y * size.width + x) * size.channels + c]} * scale);
  }
  return sum;
}

class FixedSat : public ::testing::TestWithParam<FixedCase> {};

TEST_P(FixedSat, BoxesAreExactThoughTheTableOverflows) {
  const FixedCase size = GetParam();
  const auto image =
      noise_image(size.width * size.height * size.channels, 9, size.lowest, size.highest);
  SatConfig config = of_kind(size.kind);
  config.largest_box = size.box_side * size.box_side;
  for (const std::size_t threads : {1, 2, 3, 8}) {
    const ThreadLimit limit(threads);
    const auto table =
        SummedAreaTable::build(image, size.width, size.height, size.channels, config);
    const double scale = table.fixed_point().scale;
    RandomStream random(threads);
    for (int i = 0; i < 40; ++i) {
      const std::size_t side = 1 + random.bits() % size.box_side;
      const std::size_t x = random.bits() % (size.width - side + 1);
      const std::size_t y = random.bits() % (size.height - side + 1);
      const auto units = table.box_units(x, y, x + side, y + side);
      for (std::size_t c = 0; c < size.channels; ++c)
        ASSERT_EQ(units[c], brute_units(image, size, scale, x, y, side, c));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sizes, FixedSat,
    ::testing::Values(FixedCase{SatKind::kFixed32, 640, 479, 4, 31, 0, 1},
                      FixedCase{SatKind::kFixed32, 500, 333, 3, 3, -1000, 1000},
                      FixedCase{SatKind::kFixed32, 129, 257, 1, 129, 99, 100},
                      FixedCase{SatKind::kFixed32, 129, 257, 2, 5, -100, -99},
                      FixedCase{SatKind::kFixed64, 640, 479, 4, 101, -1, 1e6F},
                      FixedCase{SatKind::kFixed64, 300, 200, 2, 200, 0, 1e-6F}));

TEST(FixedSat, IsExactAt8K) {
  constexpr std::size_t kWidth = 7680, kHeight = 4320;
  const auto image = noise_integers<std::uint8_t>(kWidth * kHeight, 8);
  const auto table = SummedAreaTable::build(image, kWidth, kHeight, 1, of_kind(SatKind::kFixed32));
  RandomStream random(1);
  for (int i = 0; i < 20; ++i) {
    const std::size_t x0 = random.bits() % kWidth, y0 = random.bits() % kHeight;
    const std::size_t x1 = std::min(kWidth, x0 + 1 + random.bits() % 400);
    const std::size_t y1 = std::min(kHeight, y0 + 1 + random.bits() % 400);
    std::int64_t sum = 0;
    for (std::size_t y = y0; y < y1; ++y) {
      for (std::size_t x = x0; x < x1; ++x) sum += image[y * kWidth + x];
    }
    ASSERT_EQ(table.box_units(x0, y0, x1, y1)[0], sum);
  }
  // 33 million pixels of 255 are more than 32 bits hold: what may not fit is refused.
  EXPECT_EQ(table.fixed_point().largest_box, 16843009U);
  EXPECT_THAT([&] { (void)table.box_sum(0, 0, kWidth, kHeight); },
              ThrowsMessage<ValueError>(HasSubstr("made for boxes of 16843009")));
}

TEST(FixedSat, WidestIntegersFit64Bits) {
  const std::vector<std::uint32_t> image(300 * 200, 0xFFFFFFFFU);
  const auto table = SummedAreaTable::build(image, 300, 200, 1, of_kind(SatKind::kFixed64));
  EXPECT_EQ(table.box_units(0, 0, 300, 200)[0], 60000LL * 0xFFFFFFFFLL);
  SatConfig config = of_kind(SatKind::kFixed32);
  config.largest_box = 2;
  EXPECT_THAT([&] { SummedAreaTable::build(image, 300, 200, 1, config); },
              ThrowsMessage<ValueError>(HasSubstr("does not fit into 32 bits")));
}

TEST(FixedPoint, IsFinerWhereBoxesAreSmallerAndNeverOverflows) {
  double last = 0;
  for (const std::size_t box : {std::size_t{1} << 30, std::size_t{1} << 20, std::size_t{9}}) {
    const FixedPoint fixed = fixed_point_for_reals({-3, 5}, box, 32);
    EXPECT_GT(fixed.scale, last);
    EXPECT_LT(static_cast<double>(box) * (8 * fixed.scale + 1), 4294967296.0);
    last = fixed.scale;
  }
  EXPECT_THROW(fixed_point_for_reals({0, 1}, std::size_t{1} << 31, 32), ValueError);
  EXPECT_NO_THROW(fixed_point_for_reals({0, 0}, 100, 32));
  EXPECT_NO_THROW(fixed_point_for_reals({-3e38, 3e38}, 100, 32));
  EXPECT_NO_THROW(fixed_point_for_reals({0, 1e-45}, 100, 64));
}

TEST(Sat, IsLinear) {
  constexpr std::size_t kWidth = 133, kHeight = 17;
  const auto a = noise_image(kWidth * kHeight, 1), b = noise_image(kWidth * kHeight, 2);
  std::vector<float> mixed(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) mixed[i] = 0.5F * a[i] + 0.25F * b[i];
  const auto sum = [&](const std::vector<float>& image) {
    return SummedAreaTable::build(image, kWidth, kHeight, 1).box_sum(3, 2, 130, 16)[0];
  };
  EXPECT_NEAR(sum(mixed), 0.5 * sum(a) + 0.25 * sum(b), 1e-4);
}

TEST(Sat, RebuildGivesTheNewImage) {
  const auto a = noise_image(50 * 40 * 2, 1), b = noise_image(50 * 40 * 2, 2, 5, 9);
  for (const SatKind kind : kSatKinds) {
    auto table = SummedAreaTable::build(a, 50, 40, 2, of_kind(kind));
    table.rebuild(b);
    const auto fresh = SummedAreaTable::build(b, 50, 40, 2, of_kind(kind));
    EXPECT_EQ(table.box_sum(7, 3, 41, 29), fresh.box_sum(7, 3, 41, 29));
  }
}

TEST(Sat, CentringKeepsSmallBoxesOfALargeImage) {
  constexpr std::size_t kWidth = 1500, kHeight = 1100;
  const auto image = noise_image(kWidth * kHeight, 3, 0.45F, 0.55F);
  const auto error = [&](SatKind kind) {
    const auto table = SummedAreaTable::build(image, kWidth, kHeight, 1, of_kind(kind));
    return std::abs(table.box_sum(1498, 1098, 1499, 1099)[0] - double{image[1098 * kWidth + 1498]});
  };
  EXPECT_LT(error(SatKind::kFloat32Centred), 1e-3);
  EXPECT_LT(error(SatKind::kFloat64), 1e-9);
  EXPECT_LT(error(SatKind::kFixed64), 1e-9);
}

TEST(Sat, TakesImagesWithoutPixels) {
  const std::vector<float> none;
  for (const SatKind kind : kSatKinds) {
    for (const auto& [width, height] : {std::pair{0, 0}, std::pair{0, 5}, std::pair{7, 0}}) {
      const auto table = SummedAreaTable::build(none, static_cast<std::size_t>(width),
                                                static_cast<std::size_t>(height), 4, of_kind(kind));
      EXPECT_EQ(table.box_sum(0, 0, table.width(), table.height()), SatSums{});
      EXPECT_THROW((void)table.box_mean(0, 0, 1, 1), ShapeError);
    }
  }
}

TEST(Sat, Takes30000Columns) {
  const auto image = noise_integers<std::uint16_t>(30000 * 5 * 3, 4);
  SatConfig config = of_kind(SatKind::kFixed64);
  const auto table = SummedAreaTable::build(image, 30000, 5, 3, config);
  std::int64_t sum = 0;
  for (std::size_t i = 2; i < image.size(); i += 3) sum += image[i];
  EXPECT_EQ(table.box_units(0, 0, 30000, 5)[2], sum);
}

TEST(Sat, NamesThePixelThatIsNotFinite) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    auto image = noise_image(20 * 10 * 2, 1);
    image[(7 * 20 + 3) * 2 + 1] = bad;
    for (const SatKind kind : {SatKind::kFixed32, SatKind::kFixed64, SatKind::kFloat32Centred})
      EXPECT_THAT([&] { SummedAreaTable::build(image, 20, 10, 2, of_kind(kind)); },
                  ThrowsMessage<ValueError>(HasSubstr("pixel (3, 7) channel 1")));
    for (const SatKind kind : {SatKind::kFloat32, SatKind::kFloat64})
      EXPECT_THAT([&] { SummedAreaTable::build(image, 20, 10, 2, of_kind(kind)); },
                  ThrowsMessage<ValueError>(HasSubstr("not finite")));
  }
}

TEST(Sat, RefusesValuesOutsideADeclaredRange) {
  SatConfig config = of_kind(SatKind::kFixed32);
  config.range = SatRange{0, 1023};
  std::vector<std::uint16_t> image(40, 1023);
  EXPECT_EQ(SummedAreaTable::build(image, 8, 5, 1, config).box_sum(0, 0, 8, 5)[0], 40 * 1023);
  image[13] = 1024;
  EXPECT_THAT([&] { SummedAreaTable::build(image, 8, 5, 1, config); },
              ThrowsMessage<ValueError>(HasSubstr("pixel (5, 1) channel 0 is 1024")));
  config.range = SatRange{1, 0};
  EXPECT_THROW(SummedAreaTable::build(image, 8, 5, 1, config), ValueError);
  config.range = SatRange{std::nan(""), 0};
  EXPECT_THROW(SummedAreaTable::build(image, 8, 5, 1, config), ValueError);
}

TEST(Sat, RefusesBadBoxes) {
  const auto image = noise_image(8 * 5, 1);
  const auto table = SummedAreaTable::build(image, 8, 5, 1);
  EXPECT_THROW((void)table.box_sum(3, 0, 2, 5), ValueError);
  EXPECT_THROW((void)table.box_sum(0, 0, 9, 5), ValueError);
  EXPECT_THROW((void)table.box_mean(1, 1, 1, 2), ValueError);
  EXPECT_THROW((void)table.box_mean(0, 0, std::nan(""), 2), ValueError);
  EXPECT_THROW((void)table.box_mean(0, 0, 1e300, 2), ValueError);
  const auto floats = SummedAreaTable::build(image, 8, 5, 1, of_kind(SatKind::kFloat64));
  EXPECT_THROW((void)floats.box_units(0, 0, 1, 1), ValueError);
}

}  // namespace
}  // namespace relumbre
