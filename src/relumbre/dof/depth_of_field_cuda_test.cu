#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/dof/cuda_test_pictures.h"
#include "relumbre/dof/depth_of_field_cuda.h"

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

constexpr Made kSizes[] = {{1, 1}, {1, 9}, {50, 1}, {7, 5}, {33, 19}, {64, 48}, {129, 17}};

TEST(SpreadCuda, MatchesCpuAtAllSizes) {
  RELUMBRE_NEEDS_DEVICE();
  for (const Made& size : kSizes) {
    for (const BlurShape shape : {BlurShape::kBox, BlurShape::kAperture}) {
      const DepthPicture picture = made_picture(size);
      const DofConfig config = spreading(lens_for(9, size.width), shape);
      const auto cpu = spread(picture, config.lens, config.spread);
      EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), 2e-6)
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
        EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), 2e-6)
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
  EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), 2e-6);
  config = spreading(lens_for(70, 33), BlurShape::kBox);
  config.spread.layers = 1;
  const auto box = spread(picture, config.lens, config.spread);
  EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), box), 2e-6);
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
    EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), 2e-6) << blades;
  }
}

TEST(SpreadCuda, MatchesCpuForAnyNumberOfLayers) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({40, 30, true, true});
  for (const std::size_t layers : {1, 2, 61}) {
    DofConfig config = spreading(lens_for(6, 40), BlurShape::kAperture);
    config.spread.layers = layers;
    const auto cpu = spread(picture, config.lens, config.spread);
    EXPECT_LT(worst_difference(cuda::depth_of_field(picture, config), cpu), 2e-6) << layers;
  }
}

}  // namespace
}  // namespace relumbre::cuda
