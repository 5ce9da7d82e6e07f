#include "relumbre/scene/ies.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Vec3f towards(double vertical_deg, double azimuth_deg) {
  const double v = vertical_deg * std::numbers::pi / 180, a = azimuth_deg * std::numbers::pi / 180;
  return Vec3f(Vec3d(std::sin(v) * std::cos(a), std::sin(v) * std::sin(a), std::cos(v)));
}

/// A file with these angles and values, all multipliers 1.
std::string ies(const std::string& counts, const std::string& numbers) {
  return "IESNA:LM-63-2002\n[TEST] none\n[MANUFAC] nobody\nTILT=NONE\n1 1000 1 " + counts +
         " 1 2 0 0 0\n1 1 50\n" + numbers + "\n";
}

const std::string kDisc = ies("3 1", "0 45 90\n0\n100 50 0");

TEST(Ies, AxialProfileInterpolatesBetweenItsAngles) {
  const IesProfile profile = parse_ies(kDisc, "disc.ies");
  EXPECT_EQ(profile.peak(), 100);
  for (const double azimuth : {0.0, 90.0, 200.0}) {
    EXPECT_NEAR(profile.relative(towards(0, azimuth)), 1, 1e-6);
    EXPECT_NEAR(profile.relative(towards(22.5, azimuth)), 0.75, 1e-5);
    EXPECT_NEAR(profile.relative(towards(45, azimuth)), 0.5, 1e-5);
    EXPECT_NEAR(profile.relative(towards(90, azimuth)), 0, 1e-5);
  }
}

TEST(Ies, IsDarkOutsideOfTheMeasuredAngles) {
  const IesProfile profile = parse_ies(ies("2 1", "0 90\n0\n1 1"), "a.ies");
  EXPECT_EQ(profile.relative(towards(89.9, 0)), 1);
  EXPECT_EQ(profile.relative({1, 0, 0}), 1);
  EXPECT_EQ(profile.relative(towards(91, 0)), 0);
  EXPECT_EQ(profile.relative({0, 0, -1}), 0);
  EXPECT_EQ(profile.relative(Vec3f(std::nanf(""))), 0);
}

TEST(Ies, AllEditionsAndLayoutsGiveTheSameProfile) {
  const IesProfile expected = parse_ies(kDisc, "disc.ies");
  const std::string body = "1 1000 1 3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n100 50 0\n";
  for (const std::string& text :
       {"LUMINAIRE X\nTILT=NONE\n" + body,  // 1986: no first line of its own
        "IESNA91\n[TEST]\nTILT=NONE\n" + body, "IESNA:LM-63-1995\nTILT=NONE \n" + body,
        std::string("IESNA91\r\nTILT=NONE\r\n1,1000,1,3,1,1,2,0,0,0\r\n1 1\r\n50 0\r\n45 90 0 "
                    "+100 5.0e1\r\n\r\n0\r\n"),
        std::string(
            "TILT=NONE\n1\n1000\n1\n3\n1\n1\n2\n0\n0\n0\n1\n1\n50\n0\n45\n90\n0\n100\n50\n0")}) {
    const IesProfile profile = parse_ies(text, "a.ies");
    EXPECT_EQ(profile.candela, expected.candela);
    EXPECT_EQ(profile.vertical_deg, expected.vertical_deg);
  }
}

TEST(Ies, CandelaAreMultiplied) {
  const IesProfile profile = parse_ies(
      "IESNA:LM-63-2002\nTILT=NONE\n1 1000 2 2 1 1 2 0 0 0\n0.5 3 50\n0 90\n0\n10 20\n", "a.ies");
  EXPECT_THAT(profile.candela, ::testing::ElementsAre(30, 60));
}

/// Which of the four values at azimuths 0, 90, 180, 270 is seen, by direction.
std::vector<float> around(const IesProfile& profile) {
  std::vector<float> values;
  for (const double azimuth : {0.0, 60.0, 90.0, 120.0, 180.0, 240.0, 270.0, 300.0}) {
    values.push_back(profile.relative(towards(90, azimuth)));
  }
  return values;
}

TEST(Ies, SymmetriesAreUnfolded) {
  const auto expect_around = [](const std::string& text, std::vector<float> expected) {
    EXPECT_THAT(around(parse_ies(text, "a.ies")),
                ::testing::Pointwise(::testing::FloatNear(1e-5F), expected));
  };
  const float a = 0.4F, b = 0.8F, c = 1;
  // One quadrant: 0.4 at 0 to 1 at 90.
  expect_around(ies("2 2", "0 90\n0 90\n0 .4\n0 1"), {a, b, c, b, a, b, c, b});
  // One half, mirrored at the plane 0-180.
  expect_around(ies("2 3", "0 90\n0 90 180\n0 .4\n0 1\n0 .7"), {a, b, c, .9F, .7F, .9F, c, b});
  // One half, mirrored at the plane 90-270.
  expect_around(ies("2 3", "0 90\n90 180 270\n0 .4\n0 1\n0 .7"),
                {c, .6F, a, .6F, c, .8F, .7F, .8F});
  // All around.
  expect_around(ies("2 5", "0 90\n0 90 180 270 360\n0 .4\n0 1\n0 .7\n0 .1\n0 .4"),
                {a, b, c, .9F, .7F, .3F, .1F, .2F});
}

TEST(Ies, RefusesWhatItCannotUseAndSaysWhy) {
  const auto refused = [](const std::string& text, const std::string& reason) {
    EXPECT_THAT([&] { parse_ies(text, "a.ies"); }, ThrowsMessage<FileError>(HasSubstr(reason)))
        << text;
  };
  refused("", "TILT");
  refused("IESNA91\n[TEST] nothing else\n", "TILT");
  refused("IESNA91\nTILT=INCLUDE\n1\n", "TILT=INCLUDE");
  refused("IESNA91\nTILT=lamp.tlt\n", "TILT=lamp.tlt");
  refused("TILT=NONE\n1 1000 1 3 1 2 2 0 0 0\n", "type B");
  refused("TILT=NONE\n1 1000 1 3 1 3 2 0 0 0\n", "type A");
  refused("TILT=NONE\n1 1000 1 3 1 7 2 0 0 0\n", "photometric type");
  refused("TILT=NONE\n1 1000 1 99999999 1 1 2 0 0 0\n", "vertical angles");
  refused("TILT=NONE\n1 1000 1 -3 1 1 2 0 0 0\n", "vertical angles");
  refused("TILT=NONE\n1 1000 1 10000 10000 1 2 0 0 0\n", "too many");
  refused("TILT=NONE\n1 1000 0 3 1 1 2 0 0 0\n", "multiplier");
  refused(ies("3 1", "0 45 90\n0\n100 50"), "ends before");
  refused(ies("3 1", "0 90 45\n0\n100 50 0"), "ascending");
  refused(ies("3 1", "0 45 900\n0\n100 50 0"), "vertical");
  refused(ies("3 1", "0 45 90\n0\n100 x 0"), "a.ies:");
  refused(ies("3 1", "0 45 90\n0\n100 nan 0"), "candela");
  refused(ies("3 1", "0 45 90\n0\n100 -1 0"), "candela");
  refused(ies("3 1", "0 45 90\n0\n0 0 0"), "every candela");
  refused(ies("2 2", "0 90\n0 45\n1 1 1 1"), "horizontal");
}

TEST(Ies, ErrorsNameTheLine) {
  EXPECT_THAT([] { parse_ies("IESNA91\nTILT=NONE\n1 1000\nx\n", "a.ies"); },
              ThrowsMessage<FileError>(HasSubstr("a.ies:4:")));
}

}  // namespace
}  // namespace relumbre
