#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/dof/blur_steps.h"
#include "relumbre/dof/cover.h"
#include "relumbre/dof/cuda_test_pictures.h"
#include "relumbre/dof/depth_of_field_cuda.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/fragments.h"
#include "relumbre/dof/infill.h"
#include "relumbre/dof/slow_box_testing.h"

namespace relumbre::cuda {
namespace {

using test::lens_for;
using test::Made;
using test::made_picture;
using test::worst_difference;

DofConfig spreading(const ThinLens& lens, BlurShape shape, int blades = 0) {
  DofConfig config{.lens = lens};
  config.spread.shape = shape;
  config.spread.aperture = {.blades = blades, .rotation_deg = 10};
  return config;
}

/// Of values up to 1, and of larger ones relative to them: a few roundings of a float.
constexpr double kTolerance = 2e-6;

constexpr Made kSizes[] = {{1, 1}, {1, 9}, {50, 1}, {7, 5}, {33, 19}, {64, 48}, {129, 17}};

TEST(SpreadCuda, MatchesCpuAtAllSizes) {
  RELUMBRE_NEEDS_DEVICE();
  for (const Made& size : kSizes) {
    for (const BlurShape shape : {BlurShape::kBox, BlurShape::kAperture}) {
      const DepthPicture picture = made_picture(size);
      const DofConfig config = spreading(lens_for(9, size.width), shape);
      const auto cpu = spread(picture, config.lens, config.spread);
      EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), kTolerance)
          << size.width << " x " << size.height << ", shape " << static_cast<int>(shape);
    }
  }
}

TEST(SpreadCuda, MatchesCpuWithAlphaAndWithWhatLiesBehind) {
  RELUMBRE_NEEDS_DEVICE();
  for (const bool alpha : {false, true}) {
    for (const bool behind : {false, true}) {
      for (const BlurShape shape : {BlurShape::kBox, BlurShape::kAperture}) {
        const DepthPicture picture = made_picture({47, 35, alpha, behind});
        const DofConfig config = spreading(lens_for(7, 47), shape);
        const auto cpu = spread(picture, config.lens, config.spread);
        EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), kTolerance)
            << "alpha " << alpha << ", behind " << behind << ", shape " << static_cast<int>(shape);
      }
    }
  }
}

TEST(SpreadCuda, MatchesCpuForBlursLargerThanThePicture) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({33, 19, false, true});
  DofConfig config = spreading(lens_for(70, 33), BlurShape::kAperture);
  const auto cpu = spread(picture, config.lens, config.spread);
  EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), kTolerance);
  config = spreading(lens_for(70, 33), BlurShape::kBox);
  config.spread.layers = 1;
  const auto box = spread(picture, config.lens, config.spread);
  EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), box), kTolerance);
}

/// A pixel of light on black, all at one depth: what the box of its blur covers of each pixel.
TEST(SpreadCuda, LightBecomesItsBoxHoweverLarge) {
  RELUMBRE_NEEDS_DEVICE();
  constexpr int kSide = 101, kMiddle = 50;
  for (const double diameter : {0.4, 3.0, 40.3, 90.0}) {
    DepthPicture picture{.width = kSide, .height = kSide, .front = {}};
    picture.front.color.assign(kSide * kSide, {0, 0, 0, 1});
    picture.front.depth.assign(kSide * kSide, 4);
    picture.front.color[kMiddle * kSide + kMiddle] = {1e6F, 0, 0, 1};
    DofConfig config = spreading(lens_for(2 * diameter, kSide), BlurShape::kBox);
    config.spread.layers = 1;
    const auto result = cuda::depth_of_field(picture, config);
    const double half = diameter * std::sqrt(3.14159265358979) / 4, level = 1e6 / (4 * half * half);
    const auto inside = [&](int i) {
      return std::max(std::min(i + 0.5, kMiddle + half) - std::max(i - 0.5, kMiddle - half), 0.0);
    };
    double worst = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double expected = level * inside(i % kSide) * inside(i / kSide);
      worst = std::max(
          worst, std::abs(static_cast<double>(result[static_cast<std::size_t>(i)].r) - expected));
    }
    EXPECT_LT(worst, 1e-6 * level) << diameter;
  }
}

TEST(SpreadCuda, MatchesCpuForPolygons) {
  RELUMBRE_NEEDS_DEVICE();
  for (const int blades : {3, 5, 6, 8}) {
    const DepthPicture picture = made_picture({40, 30});
    const DofConfig config = spreading(lens_for(8, 40), BlurShape::kAperture, blades);
    const auto cpu = spread(picture, config.lens, config.spread);
    EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), kTolerance) << blades;
  }
}

/// Which the CPU spreads along their edges: those that slant are up to a pixel softer, which shows
/// most round lamps of 40.
TEST(SpreadCuda, LargePolygonsDifferFromTheCpusAtTheirEdgesOnly) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({70, 50});
  DofConfig config = spreading(lens_for(60, 70), BlurShape::kAperture, 6);
  config.spread.aperture.rotation_deg = 0;
  const auto cpu = spread(picture, config.lens, config.spread);
  EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), 0.04);
}

TEST(SpreadCuda, MatchesCpuForAnyNumberOfLayers) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({40, 30, true, true});
  for (const std::size_t layers : {1, 2, 61}) {
    DofConfig config = spreading(lens_for(6, 40), BlurShape::kAperture);
    config.spread.layers = layers;
    const auto cpu = spread(picture, config.lens, config.spread);
    EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), kTolerance) << layers;
  }
}

TEST(SpreadCuda, SilhouettesRevealTheSameInTilesAsInTheWholePicture) {
  RELUMBRE_NEEDS_DEVICE();
  // Blurs for which tiles are of 64 and of 256 pixels, and for which the picture is one.
  for (const double blur : {6.0, 30.0, 110.0, 400.0}) {
    for (const Made& size : {Made{150, 9, false, true}, Made{9, 140, false, true}}) {
      const DepthPicture picture = made_picture(size);
      DofConfig config = spreading(lens_for(blur, size.width), BlurShape::kAperture);
      config.spread.layers = 3;
      const auto cpu = spread(picture, config.lens, config.spread);
      EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), kTolerance)
          << size.width << " x " << size.height << ", blur " << blur;
    }
  }
}

TEST(SpreadCuda, NothingIsSeenBehindWhatIsInFocus) {
  RELUMBRE_NEEDS_DEVICE();
  // Tiles may stop at the front, of whose layer nothing is open.
  DepthPicture picture = made_picture({70, 20, false, true});
  std::fill(picture.front.depth.begin(), picture.front.depth.end(), 2.0F);
  const DofConfig config = spreading(lens_for(9, 70), BlurShape::kAperture);
  EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), picture.front.color),
            kTolerance);
}

/// All methods, with the box and the aperture for the one that has both.
std::vector<DofConfig> all_methods(const ThinLens& lens) {
  std::vector<DofConfig> result{spreading(lens, BlurShape::kBox),
                                spreading(lens, BlurShape::kAperture),
                                spreading(lens, BlurShape::kAperture, 6)};
  for (const DofMethod method : {DofMethod::kGather, DofMethod::kLayered}) {
    result.push_back({.lens = lens});
    result.back().method = method;
  }
  return result;
}

double sum_of(const std::vector<Rgba>& picture) {
  double sum = 0;
  for (const Rgba& c : picture) sum += static_cast<double>(c.r);
  return sum;
}

TEST(DofCuda, ConstantPictureStaysConstant) {
  RELUMBRE_NEEDS_DEVICE();
  const Rgba color{0.5F, 0.25F, 3, 1};
  DepthPicture picture = made_picture({45, 31});
  std::fill(picture.front.color.begin(), picture.front.color.end(), color);
  const std::vector<Rgba> constant(picture.pixels(), color);
  for (const DofConfig& config : all_methods(lens_for(12, 45)))
    EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), constant), 1e-6)
        << static_cast<int>(config.method);
}

TEST(DofCuda, WhatIsInFocusIsUntouched) {
  RELUMBRE_NEEDS_DEVICE();
  DepthPicture picture = made_picture({45, 31});
  std::fill(picture.front.depth.begin(), picture.front.depth.end(), 2.0F);
  for (const DofConfig& config : all_methods(lens_for(12, 45)))
    EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), picture.front.color), 1e-6)
        << static_cast<int>(config.method);
}

TEST(DofCuda, EnergyIsKept) {
  RELUMBRE_NEEDS_DEVICE();
  // Light in the middle, far from the border.
  DepthPicture picture = made_picture({80, 60});
  RandomStream random(3);
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const bool middle = i % 80 > 25 && i % 80 < 55 && i / 80 > 20 && i / 80 < 40;
    picture.front.color[i] = {middle ? random.uniform() : 0, 0, 0, 1};
    picture.front.depth[i] = 4;
  }
  const double energy = sum_of(picture.front.color);
  for (const DofConfig& config : all_methods(lens_for(26, 80)))
    EXPECT_NEAR(sum_of(cuda::depth_of_field(picture, config)), energy, 1e-5 * energy)
        << static_cast<int>(config.method);
}

TEST(DofCuda, SameBitsInEveryRun) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({66, 19, true, true});
  DeviceDof dof(66, 19, true);
  dof.upload(picture);
  for (const DofConfig& config : all_methods(lens_for(8, 66))) {
    dof.run(config);
    const auto first = dof.download();
    for (int i = 0; i < 2; ++i) {
      dof.run(config);
      EXPECT_EQ(worst_difference(dof.download(), first), 0) << static_cast<int>(config.method);
    }
  }
}

TEST(DofCuda, MemoryServesOnePictureAndLensAfterAnother) {
  RELUMBRE_NEEDS_DEVICE();
  DeviceDof dof(21, 18, true);
  for (const bool behind : {true, false, true}) {
    for (const double blur : {3.0, 11.0, 5.0}) {
      for (DofConfig config : all_methods(lens_for(blur, 21))) {
        const DepthPicture picture = made_picture({21, 18, false, behind});
        config.spread.layers = static_cast<std::size_t>(blur);
        dof.upload(picture);
        dof.run(config);
        EXPECT_EQ(worst_difference(dof.download(), cuda::depth_of_field(picture, config)), 0)
            << behind << ", blur " << blur << ", method " << static_cast<int>(config.method);
      }
    }
  }
}

TEST(DofCuda, GuessesWhatLiesBehindAsTheCpuDoes) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({40, 30});
  DofConfig config = spreading(lens_for(9, 40), BlurShape::kAperture);
  config.infill = true;
  const DepthPicture whole = infilled(picture, config.lens, config.spread.largest_diameter);
  const auto cpu = spread(whole, config.lens, config.spread);
  EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), kTolerance);
  DeviceDof dof(40, 30, false);
  dof.upload(picture);
  EXPECT_THROW(dof.run(config), ValueError);
}

/// gather() in plain loops.
std::vector<Rgba> slow_gather(const DepthPicture& picture, const ThinLens& lens) {
  std::vector<float> radii = circles_of_confusion(picture.front.depth, lens, picture.width, 512);
  for (float& circle : radii) circle = box_radius(circle);
  return test::slow_box(picture.front.color, picture.width, picture.height, radii);
}

TEST(GatherCuda, MatchesPlainLoops) {
  RELUMBRE_NEEDS_DEVICE();
  for (const Made& size : kSizes) {
    const DepthPicture picture = made_picture({size.width, size.height, true, true});
    DofConfig config{.lens = lens_for(9, size.width)};
    config.method = DofMethod::kGather;
    EXPECT_LT(
        worst_difference(cuda::depth_of_field(picture, config), slow_gather(picture, config.lens)),
        kTolerance)
        << size.width << " x " << size.height;
  }
}

/// layered() in plain loops: every step's picture is drawn and blurred as a whole.
std::vector<Rgba> slow_layered(const DepthPicture& picture, const ThinLens& lens,
                               std::size_t layers) {
  const auto circles = [&](const PictureLayer& layer) {
    return circles_of_confusion(layer.depth, lens, picture.width, 512);
  };
  const auto fragments = fragments_of(picture, circles(picture.front), circles(picture.behind));
  const auto by_coc = [](const Fragment& a, const Fragment& b) { return a.coc < b.coc; };
  const auto [least, largest] = std::minmax_element(fragments.begin(), fragments.end(), by_coc);
  const std::vector<float> steps = blur_steps(least->coc, largest->coc, layers);
  Cover cover(picture.pixels());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    std::vector<Rgba> colors(picture.pixels()), weights(picture.pixels());
    for (const Fragment& f : fragments) {
      float share = 0;
      if (i > 0 && f.coc >= steps[i - 1] && f.coc < steps[i])
        share = share_of_next(f.coc, steps[i - 1], steps[i]);
      else if (i + 1 == steps.size())
        share = f.coc >= steps[i] ? 1.0F : 0.0F;
      else if (f.coc >= steps[i] && f.coc < steps[i + 1])
        share = 1 - share_of_next(f.coc, steps[i], steps[i + 1]);
      Rgba& c = colors[f.y * picture.width + f.x];
      c = {c.r + share * f.color.r, c.g + share * f.color.g, c.b + share * f.color.b,
           c.a + share * f.color.a};
      weights[f.y * picture.width + f.x].r += share * f.coverage;
    }
    const std::vector<float> radii(picture.pixels(), box_radius_of(steps[i]));
    const auto color = test::slow_box(colors, picture.width, picture.height, radii);
    const auto weight = test::slow_box(weights, picture.width, picture.height, radii);
    const double tolerance = tolerance_of(std::abs(static_cast<double>(steps[i])));
    for (std::size_t p = 0; p < picture.pixels(); ++p)
      cover.add(p, color[p], static_cast<double>(weight[p].r), tolerance);
  }
  std::vector<Rgba> result;
  for (std::size_t p = 0; p < picture.pixels(); ++p) result.push_back(cover.color(p));
  return result;
}

TEST(LayeredCuda, MatchesPlainLoops) {
  RELUMBRE_NEEDS_DEVICE();
  for (const Made& size : kSizes) {
    for (const bool behind : {false, true}) {
      const DepthPicture picture = made_picture({size.width, size.height, behind, behind});
      DofConfig config{.lens = lens_for(9, size.width)};
      config.method = DofMethod::kLayered;
      config.layered_steps = 7;
      EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config),
                                 slow_layered(picture, config.lens, 7)),
                kTolerance)
          << size.width << " x " << size.height << ", behind " << behind;
    }
  }
}

TEST(DofCuda, BadInputIsRefusedAsTheCpuRefusesIt) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({8, 6});
  for (const DofConfig& good : all_methods(lens_for(4, 8))) {
    DofConfig config = good;
    config.lens.f_number = 0;
    EXPECT_THROW(cuda::depth_of_field(picture, config), ValueError);
    config = good;
    config.spread.largest_diameter = -1;
    EXPECT_THROW(cuda::depth_of_field(picture, config), ValueError);
    config = good;
    config.spread.largest_diameter = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(cuda::depth_of_field(picture, config), ValueError);
    if (good.method == DofMethod::kGather) continue;
    config = good;
    config.spread.layers = config.layered_steps = 0;
    EXPECT_THROW(cuda::depth_of_field(picture, config), ValueError);
  }
  DofConfig too_blurred{.lens = lens_for(1e5, 8)};
  too_blurred.method = DofMethod::kLayered;
  too_blurred.spread.largest_diameter = 1e5;
  EXPECT_THROW(cuda::depth_of_field(picture, too_blurred), ValueError);
  DofConfig two_blades = spreading(lens_for(4, 8), BlurShape::kAperture, 2);
  EXPECT_THROW(cuda::depth_of_field(picture, two_blades), ValueError);
  DepthPicture bad = picture;
  bad.front.depth[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(cuda::depth_of_field(bad, {}), ValueError);
  EXPECT_THROW(cuda::depth_of_field({}, {}), ShapeError);
  DeviceDof dof(8, 6, false);
  EXPECT_THROW(dof.run({}), ValueError);
  EXPECT_THROW(dof.upload(made_picture({6, 8})), ShapeError);
  EXPECT_THROW(dof.upload(made_picture({8, 6, false, true})), ShapeError);
}

TEST(DofCuda, TooLargeAPictureIsRefusedBeforeAnythingIsAllocated) {
  RELUMBRE_NEEDS_DEVICE();
  EXPECT_THROW(DeviceDof(std::size_t{1} << 40, std::size_t{1} << 40, false), ShapeError);
  const DepthPicture picture = made_picture({8, 6});
  DofConfig config = spreading(lens_for(4, 8), BlurShape::kBox);
  config.spread.layers = 0x7FFFFFFF;
  EXPECT_THROW(cuda::depth_of_field(picture, config), ValueError);
}

}  // namespace
}  // namespace relumbre::cuda
