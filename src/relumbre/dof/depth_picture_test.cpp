#include "relumbre/dof/depth_picture.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Every channel has one value everywhere: its place in the list, from 1.
Image numbered(std::vector<std::string> names, std::size_t width = 3, std::size_t height = 2) {
  Image image(width, height, names);
  float value = 1;
  for (const std::string& name : names) std::ranges::fill(image.channel(name), value++);
  return image;
}

void expect_all(const PictureLayer& layer, const Rgba& color, float depth) {
  EXPECT_THAT(layer.color, Each(color));
  EXPECT_THAT(layer.depth, Each(depth));
}

/// One row whose depths are these.
Image with_depths(const std::vector<float>& depths) {
  Image image = numbered({"R", "G", "B", "Z"}, depths.size(), 1);
  std::ranges::copy(depths, image.channel("Z").begin());
  return image;
}

TEST(DepthPicture, FindsPlainChannels) {
  const DepthPicture picture = depth_picture(numbered({"A", "B", "G", "R", "Z"}));
  EXPECT_EQ(picture.width, 3U);
  EXPECT_EQ(picture.height, 2U);
  EXPECT_FALSE(picture.has_behind());
  expect_all(picture.front, {4, 3, 2, 1}, 5);
}

TEST(DepthPicture, FindsWhatBlenderWrites) {
  for (const std::string depth : {"ViewLayer.Depth.Z", "ViewLayer.Depth.V"}) {
    const DepthPicture picture = depth_picture(
        numbered({"ViewLayer.AO.B", "ViewLayer.AO.G", "ViewLayer.AO.R", "ViewLayer.Combined.A",
                  "ViewLayer.Combined.B", "ViewLayer.Combined.G", "ViewLayer.Combined.R", depth}));
    expect_all(picture.front, {7, 6, 5, 4}, 8);
  }
}

TEST(DepthPicture, FindsALayerOfAnyName) {
  const DepthPicture picture =
      depth_picture(numbered({"beauty.B", "beauty.G", "beauty.R", "depth.Z", "normal.R"}));
  expect_all(picture.front, {3, 2, 1, 1}, 4);
}

TEST(DepthPicture, PlainChannelsComeBeforeLayers) {
  const DepthPicture picture = depth_picture(
      numbered({"AO.B", "AO.G", "AO.R", "Depth.Z", "A", "B", "G", "R", "Z", "albedo.R"}));
  expect_all(picture.front, {8, 7, 6, 5}, 9);
}

TEST(DepthPicture, TakesTheChannelsThatAreChosen) {
  const Image image = numbered({"A", "B", "G", "R", "Z", "fog.B", "fog.G", "fog.R", "far"});
  const DepthPicture picture = depth_picture(image, {.color = "fog.", .depth = "far"});
  expect_all(picture.front, {8, 7, 6, 1}, 9);
  expect_all(depth_picture(image, {.color = "", .depth = "Z"}).front, {4, 3, 2, 1}, 5);
}

std::vector<std::string> view_layer(const std::string& name, bool depth) {
  std::vector<std::string> names{name + ".Combined.B", name + ".Combined.G", name + ".Combined.R"};
  if (depth) names.push_back(name + ".Depth.Z");
  return names;
}

Image two_layers(bool first_has_depth, bool second_has_depth) {
  std::vector<std::string> names = view_layer("Back", first_has_depth);
  const auto second = view_layer("Front", second_has_depth);
  names.insert(names.end(), second.begin(), second.end());
  return numbered(names);
}

TEST(DepthPicture, ColourAndDepthAreOfOneViewLayer) {
  // The only layer that has both, whichever comes first.
  expect_all(depth_picture(two_layers(true, false)).front, {3, 2, 1, 1}, 4);
  expect_all(depth_picture(two_layers(false, true)).front, {6, 5, 4, 1}, 7);
  // Of two, the one that is asked for, by its colour or by its depth.
  const Image both = two_layers(true, true);
  expect_all(depth_picture(both, {.color = "Front.Combined."}).front, {7, 6, 5, 1}, 8);
  expect_all(depth_picture(both, {.depth = "Front.Depth.Z"}).front, {7, 6, 5, 1}, 8);
  // Mixed only on request.
  const DepthPictureConfig mixed{.color = "Front.Combined.", .depth = "Back.Depth.Z"};
  expect_all(depth_picture(both, mixed).front, {7, 6, 5, 1}, 4);
}

TEST(DepthPicture, OfSeveralViewLayersNoneIsTakenByChance) {
  EXPECT_THAT(
      [] { (void)depth_picture(two_layers(true, true)); },
      ThrowsMessage<ValueError>(AllOf(HasSubstr("Back.Combined."), HasSubstr("Front.Combined."))));
  EXPECT_THAT(
      [] { (void)depth_picture(two_layers(true, false), {.color = "Front.Combined."}); },
      ThrowsMessage<ValueError>(AllOf(HasSubstr("Front.Combined."), HasSubstr("Back.Depth.Z"))));
  EXPECT_THAT(
      [] {
        (void)depth_picture(numbered({"R", "G", "B", "near.Depth.Z", "far.Depth.Z"}));
      },
      ThrowsMessage<ValueError>(AllOf(HasSubstr("near.Depth.Z"), HasSubstr("far.Depth.Z"))));
}

TEST(DepthPicture, WithoutAlphaItIsOpaque) {
  expect_all(depth_picture(numbered({"B", "G", "R", "Z"})).front, {3, 2, 1, 1}, 4);
}

TEST(DepthPicture, StraightAlphaIsMultipliedIn) {
  Image image = numbered({"A", "B", "G", "R", "Z"});
  std::ranges::fill(image.channel("A"), 0.25F);
  expect_all(depth_picture(image).front, {4, 3, 2, 0.25F}, 5);
  expect_all(depth_picture(image, {.straight_alpha = true}).front, {1, 0.75F, 0.5F, 0.25F}, 5);
}

TEST(DepthPicture, WhatHasNoDepthIsInfinitelyFar) {
  const DepthPicture picture =
      depth_picture(with_depths({0, kInf, 1e9F, 1e10F, 1e30F, 65504, 9.9e8F, 1e-30F}));
  EXPECT_THAT(picture.front.depth,
              ElementsAre(kInf, kInf, kInf, kInf, kInf, 65504, 9.9e8F, 1e-30F));
}

TEST(DepthPicture, ReadsWhatLiesBehind) {
  Image image = numbered(
      {"A", "B", "G", "R", "Z", "layer1.A", "layer1.B", "layer1.G", "layer1.R", "layer1.Z"});
  const DepthPicture picture = depth_picture(image);
  expect_all(picture.front, {4, 3, 2, 1}, 5);
  ASSERT_TRUE(picture.has_behind());
  expect_all(picture.behind, {9, 8, 7, 6}, 10);

  auto z = image.channel("layer1.Z");
  z[0] = 0, z[1] = kInf, z[2] = 1e10F;
  const DepthPicture partly = depth_picture(image);
  EXPECT_THAT(partly.behind.depth, ElementsAre(0, kInf, kInf, 10, 10, 10));
}

TEST(DepthPicture, AnIncompleteSecondLayerIsIgnored) {
  EXPECT_FALSE(depth_picture(numbered({"B", "G", "R", "Z", "layer1.B", "layer1.G", "layer1.R"}))
                   .has_behind());
  EXPECT_FALSE(depth_picture(numbered({"B", "G", "R", "Z", "layer1.R", "layer1.Z"})).has_behind());
}

TEST(DepthPicture, TheSecondLayerIsNotTakenForTheFirst) {
  EXPECT_THAT(
      [] {
        (void)depth_picture(numbered({"layer1.B", "layer1.G", "layer1.R", "layer1.Z", "Z"}));
      },
      ThrowsMessage<ValueError>(HasSubstr("no channels R, G, B")));
}

TEST(DepthPicture, RadialDepthBecomesPlanar) {
  // A wall at 3 m, seen by rays: distance = depth / cos.
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {9, 1}, {64, 37}}) {
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    constexpr double kPixels = 21.5;
    Image image =
        numbered({"B", "G", "R", "Z", "layer1.B", "layer1.G", "layer1.R", "layer1.Z"}, w, h);
    for (std::size_t i = 0; i < w * h; ++i) {
      const double x = (static_cast<double>(i % w) + 0.5 - width / 2.0) / kPixels,
                   y = (static_cast<double>(i / w) + 0.5 - height / 2.0) / kPixels;
      const double slant = std::sqrt(1 + x * x + y * y);
      image.channel("Z")[i] = static_cast<float>(3 * slant);
      image.channel("layer1.Z")[i] = static_cast<float>(7 * slant);
    }
    const DepthPicture picture =
        depth_picture(image, {.radial = true, .pixels_per_tangent = kPixels});
    for (const float z : picture.front.depth) ASSERT_NEAR(z, 3, 4e-7);
    for (const float z : picture.behind.depth) ASSERT_NEAR(z, 7, 1e-6);
  }
}

TEST(DepthPicture, NothingStaysNothingWhenRadial) {
  Image image = with_depths({kInf, 1, 0});
  const auto picture = depth_picture(image, {.radial = true, .pixels_per_tangent = 1});
  EXPECT_THAT(picture.front.depth, ElementsAre(kInf, 1, kInf));
}

TEST(DepthPicture, RadialNeedsTheAngleOfView) {
  const Image image = numbered({"B", "G", "R", "Z"});
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW((void)depth_picture(image, {.radial = true, .pixels_per_tangent = bad}),
                 ValueError);
  }
}

TEST(DepthPicture, NamesTheChannelThatIsMissingAndThoseThatAreThere) {
  EXPECT_THAT(
      [] {
        (void)depth_picture(numbered({"A", "B", "G", "R"}));
      },
      ThrowsMessage<ValueError>(AllOf(HasSubstr("(Z)"), HasSubstr("A, B, G, R"))));
  EXPECT_THAT(
      [] {
        (void)depth_picture(numbered({"G", "R", "Z"}));
      },
      ThrowsMessage<ValueError>(AllOf(HasSubstr("R, G, B"), HasSubstr("G, R, Z"))));
  const Image image = numbered({"B", "G", "R", "Z"});
  EXPECT_THAT([&] { (void)depth_picture(image, {.color = "fog."}); },
              ThrowsMessage<ValueError>(AllOf(HasSubstr("fog.R"), HasSubstr("B, G, R, Z"))));
  EXPECT_THAT([&] { (void)depth_picture(image, {.depth = "W"}); },
              ThrowsMessage<ValueError>(AllOf(HasSubstr("channel W"), HasSubstr("B, G, R, Z"))));
}

TEST(DepthPicture, NamesThePixelWhoseDepthIsNone) {
  for (const float bad : {std::nanf(""), -1.0F, -kInf, -1e-30F}) {
    for (const char* channel : {"Z", "layer1.Z"}) {
      Image image =
          numbered({"B", "G", "R", "Z", "layer1.B", "layer1.G", "layer1.R", "layer1.Z"}, 17, 13);
      image.channel(channel)[5 * 17 + 4] = bad;
      EXPECT_THAT([&] { (void)depth_picture(image); },
                  ThrowsMessage<ValueError>(HasSubstr("pixel 4,5")));
    }
  }
}

TEST(DepthPicture, NamesThePixelWhoseColourIsNotFinite) {
  for (const float bad : {std::nanf(""), kInf, -kInf}) {
    for (const char* channel : {"R", "G", "B", "A"}) {
      Image image = numbered({"A", "B", "G", "R", "Z"}, 4, 4);
      image.channel(channel)[6] = bad;
      EXPECT_THAT([&] { (void)depth_picture(image); },
                  ThrowsMessage<ValueError>(HasSubstr("pixel 2,1")));
    }
  }
}

TEST(DepthPicture, WithoutPixelsIsRefused) {
  EXPECT_THROW(DepthPicture{}.check(), ShapeError);
  EXPECT_THROW((DepthPicture{.width = 4, .height = 0, .front = {}}.check()), ShapeError);
  EXPECT_THROW((void)depth_picture(Image()), Error);
}

TEST(DepthPicture, PlanesMustFitTheSize) {
  DepthPicture picture = test::plane(5, 3, 2);
  picture.check();
  picture.front.depth.pop_back();
  EXPECT_THROW(picture.check(), ShapeError);
  picture = test::plane(5, 3, 2);
  picture.behind = test::plane(3, 3, 4).front;
  EXPECT_THROW(picture.check(), ShapeError);
}

TEST(DepthPicture, OnlyWhatLiesBehindMayBeUnknown) {
  DepthPicture picture = test::plane(5, 3, 2);
  picture.behind = test::plane(5, 3, 4).front;
  picture.behind.depth[7] = 0;
  picture.check();
  picture.front.depth[7] = 0;
  EXPECT_THROW(picture.check(), ValueError);
}

TEST(DepthPicture, IsOpaqueWhereverThereIsSomething) {
  DepthPicture picture = test::plane(3, 2, 1);
  EXPECT_TRUE(picture.opaque());
  picture.behind = test::plane(3, 2, 4).front;
  picture.behind.color[4].a = 0, picture.behind.depth[4] = 0;
  EXPECT_TRUE(picture.opaque());
  picture.behind.depth[4] = 7;
  EXPECT_FALSE(picture.opaque());
  picture.behind = {};
  picture.front.color[1].a = 0.5F;
  EXPECT_FALSE(picture.opaque());
}

TEST(DepthPicture, BecomesAnImageAgain) {
  const DepthPicture picture = test::noise(7, 5, 2);
  const Image image = image_of(picture.front.color, 7, 5);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const Rgba c{image.channel("R")[i], image.channel("G")[i], image.channel("B")[i],
                 image.channel("A")[i]};
    EXPECT_EQ(c, picture.front.color[i]);
  }
}

}  // namespace
}  // namespace relumbre
