#include "relumbre/image/tone_map.h"

#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Image filled(std::size_t width, std::size_t height, const Rgb& c) {
  Image image = rgb_image(width, height);
  for (std::size_t i = 0; i < image.pixels(); ++i) image.set_rgb(i, c);
  return image;
}

TEST(Srgb, MatchesTheStandardsValues) {
  EXPECT_EQ(srgb_encode(0), 0);
  EXPECT_NEAR(srgb_encode(1), 1, 1e-6);
  EXPECT_NEAR(srgb_encode(0.5F), 0.7353570, 1e-6);
  EXPECT_NEAR(srgb_encode(0.0031308F), 0.0404500, 1e-6);
  EXPECT_NEAR(srgb_decode(0.5F), 0.2140411, 1e-6);
  EXPECT_NEAR(srgb_decode(0.04F), 0.04 / 12.92, 1e-8);
}

TEST(Srgb, EncodeInvertsDecodeAtEveryByte) {
  for (int i = 0; i < 256; ++i) {
    const float encoded = static_cast<float>(i) / 255;
    EXPECT_NEAR(srgb_encode(srgb_decode(encoded)), encoded, 1e-6);
    EXPECT_EQ(to_byte(srgb_encode(srgb_decode(encoded))), i);
  }
}

TEST(ToByte, ClampsAndTakesNanAsBlack) {
  EXPECT_EQ(to_byte(-1), 0);
  EXPECT_EQ(to_byte(kNan), 0);
  EXPECT_EQ(to_byte(kInf), 255);
  EXPECT_EQ(to_byte(0.5F), 128);
}

TEST(ToneCurve, RisesFromBlackToWhite) {
  for (const ToneCurve curve : {ToneCurve::kFilmic, ToneCurve::kSrgb}) {
    EXPECT_EQ(display_color(Rgb(0.0F), curve).x, 0);
    float before = 0;
    for (float x = 1e-4F; x < 1e9F; x *= 1.1F) {
      const float y = display_color(Rgb(x), curve).x;
      EXPECT_GE(y, before);
      EXPECT_LE(y, 1.000001F);
      before = y;
    }
    EXPECT_NEAR(before, 1, 1e-6);
  }
}

TEST(ToneCurve, FilmicHasThePublishedValues) {
  // Narkowicz's rational curve at 1 and at middle grey, by hand: 2.54 / 3.16, 0.086724 / 0.324932.
  EXPECT_NEAR(display_color(Rgb(1.0F), ToneCurve::kFilmic).x, srgb_encode(2.54F / 3.16F), 1e-6);
  EXPECT_NEAR(display_color(Rgb(0.18F), ToneCurve::kFilmic).x, srgb_encode(0.086724F / 0.324932F),
              1e-5);
}

TEST(ToneMap, OneStopDoubles) {
  const Image image = filled(3, 2, {0.1F, 0.2F, 0.05F}), twice = filled(3, 2, {0.2F, 0.4F, 0.1F});
  EXPECT_EQ(tone_map(image, {.exposure_stops = 1}), tone_map(twice));
  EXPECT_NE(tone_map(image), tone_map(twice));
}

TEST(ToneMap, SrgbKeepsDisplayValues) {
  const Image image = filled(1, 1, {srgb_decode(10 / 255.0F), srgb_decode(1 / 255.0F), 5});
  EXPECT_EQ(tone_map(image, {.curve = ToneCurve::kSrgb}), (std::vector<std::uint8_t>{10, 1, 255}));
}

TEST(ToneMap, TakesEveryFloat) {
  Image image = rgb_image(4, 1);
  image.set_rgb(0, {kNan, kInf, -kInf});
  image.set_rgb(1, {-1, 3e38F, 1e-45F});
  for (const ToneCurve curve : {ToneCurve::kFilmic, ToneCurve::kSrgb}) {
    for (const float stops : {-1e30F, -10.0F, 0.0F, 10.0F, 1e30F}) {
      const auto bytes =
          tone_map(image, {.exposure_stops = stops, .auto_exposure = true, .curve = curve});
      EXPECT_EQ(bytes[0], 0);
      EXPECT_EQ(bytes[1], 255);
      EXPECT_EQ(bytes[2], 0);
    }
  }
  EXPECT_THROW(tone_map(image, {.exposure_stops = kNan}), ValueError);
}

TEST(ToneMap, BytesAreTheRoundedValues) {
  Image image = rgb_image(131, 127);
  RandomStream random(2);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    image.set_rgb(i, {random.uniform() * 2, random.uniform(), random.uniform() * 0.01F});
  }
  const Image display = tone_mapped(image);
  const auto bytes = tone_map(image);
  for (std::size_t i = 0; i < image.pixels(); ++i)
    EXPECT_EQ(bytes[3 * i + 1], to_byte(display.rgb(i).y));
}

TEST(ToneMap, ThreadsDoNotChangeThePicture) {
  const Image image = filled(300, 200, {0.3F, 0.4F, 0.5F});
  const auto all = tone_map(image, {.auto_exposure = true});
  const ThreadLimit one(1);
  EXPECT_EQ(tone_map(image, {.auto_exposure = true}), all);
}

TEST(AutoExposure, BringsAnEvenImageToMiddleGrey) {
  for (const float level : {1e-6F, 0.18F, 3.0F, 1e6F}) {
    EXPECT_NEAR(level * std::exp2(auto_exposure_stops(filled(7, 5, Rgb(level)))), 0.18, 1e-3);
  }
}

TEST(AutoExposure, FourTimesTheLightIsTwoStopsLess) {
  Image image = rgb_image(64, 64), brighter = rgb_image(64, 64);
  RandomStream random(4);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float v = std::exp2(10 * random.uniform());
    image.set_rgb(i, Rgb(v));
    brighter.set_rgb(i, Rgb(4 * v));
  }
  EXPECT_NEAR(auto_exposure_stops(brighter), auto_exposure_stops(image) - 2, 1e-4);
}

TEST(AutoExposure, LampsBlackAndBrokenPixelsDoNotDecide) {
  Image image = filled(10, 10, Rgb(0.5F));
  const float clean = auto_exposure_stops(image);
  for (std::size_t i = 0; i < 4; ++i) image.set_rgb(i, Rgb(1e9F));
  for (std::size_t i = 10; i < 14; ++i) image.set_rgb(i, Rgb(1e-9F));
  for (std::size_t i = 20; i < 30; ++i) image.set_rgb(i, Rgb(0.0F));
  image.set_rgb(30, Rgb(kNan));
  image.set_rgb(31, Rgb(kInf));
  image.set_rgb(32, Rgb(-5.0F));
  EXPECT_NEAR(auto_exposure_stops(image), clean, 1e-5);
}

TEST(AutoExposure, ABlackImageStaysAsItIs) {
  EXPECT_EQ(auto_exposure_stops(rgb_image(5, 5)), 0);
  EXPECT_EQ(auto_exposure_stops(filled(1, 1, Rgb(0.18F))),
            auto_exposure_stops(filled(2, 1, Rgb(0.18F))));
}

TEST(ToneMap, NeedsColour) {
  const std::vector<std::string> names = {"Z"};
  EXPECT_THROW(tone_map(Image(2, 2, names)), ValueError);
  EXPECT_THROW(auto_exposure_stops(Image(2, 2, names)), ValueError);
}

}  // namespace
}  // namespace relumbre
