#include "relumbre/dof/depth_of_field.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/gather.h"
#include "relumbre/dof/infill.h"
#include "relumbre/dof/layered.h"
#include "relumbre/dof/test_pictures.h"

namespace relumbre {
namespace {

using test::add_rectangle, test::noise, test::plane, test::scatter_depths;

const ThinLens kLens{
    .focal_length_mm = 50, .f_number = 1.4, .focus_distance_m = 2, .sensor_width_mm = 36};
constexpr DofMethod kMethods[] = {DofMethod::kGather, DofMethod::kLayered, DofMethod::kSpread};

/// Something blurred before a wall in focus.
DepthPicture foreground() {
  DepthPicture picture = noise(200, 60, 2);
  add_rectangle(picture, 60, 140, 10, 50, 0.8F, {1, 0, 0, 1});
  return picture;
}

DofConfig config_of(DofMethod method) {
  DofConfig config{.lens = kLens, .method = method};
  config.spread.layers = config.layered_steps = 9;
  config.spread.largest_diameter = 12;
  return config;
}

TEST(DepthOfField, TheMethodIsTheOneAskedFor) {
  DepthPicture picture = noise(70, 50, 2);
  scatter_depths(picture, 0.5F, 20);
  EXPECT_EQ(depth_of_field(picture, config_of(DofMethod::kGather)), gather(picture, kLens, 12));
  EXPECT_EQ(depth_of_field(picture, config_of(DofMethod::kLayered)),
            layered(picture, kLens, {.layers = 9, .largest_diameter = 12}));
  const DofConfig spreading = config_of(DofMethod::kSpread);
  EXPECT_EQ(depth_of_field(picture, spreading), spread(picture, kLens, spreading.spread));
}

TEST(DepthOfField, ShapesAreOfSpread) {
  const DepthPicture picture = foreground();
  for (const DofMethod method : kMethods) {
    DofConfig disc = config_of(method), triangle = disc;
    triangle.spread.aperture.blades = 3;
    EXPECT_EQ(depth_of_field(picture, disc) == depth_of_field(picture, triangle),
              method != DofMethod::kSpread);
  }
}

TEST(DepthOfField, InfillIsAGuessedLayerBehind) {
  const DepthPicture picture = foreground();
  DepthPicture guessed = picture;
  guessed.behind =
      fill_behind(picture, circles_of_confusion(picture.front.depth, kLens, picture.width, 12));
  for (const DofMethod method : {DofMethod::kLayered, DofMethod::kSpread}) {
    DofConfig config = config_of(method);
    const auto without = depth_of_field(picture, config);
    config.infill = true;
    const auto with = depth_of_field(picture, config);
    EXPECT_NE(with, without);
    EXPECT_EQ(with, depth_of_field(guessed, config));
  }
}

TEST(DepthOfField, InfillDoesNotReplaceWhatIsKnown) {
  DepthPicture picture = foreground();
  picture.behind = noise(200, 60, 2).front;
  for (const DofMethod method : kMethods) {
    DofConfig config = config_of(method);
    const auto known = depth_of_field(picture, config);
    config.infill = true;
    EXPECT_EQ(depth_of_field(picture, config), known);
  }
}

TEST(DepthOfField, GatherKnowsNothingOfWhatLiesBehind) {
  DepthPicture picture = foreground();
  DofConfig config = config_of(DofMethod::kGather);
  const auto alone = depth_of_field(picture, config);
  config.infill = true;
  EXPECT_EQ(depth_of_field(picture, config), alone);
  picture.behind = plane(200, 60, 9).front;
  EXPECT_EQ(depth_of_field(picture, config), alone);
}

TEST(DepthOfField, BadPicturesAndLensesAreRefusedByAll) {
  for (const DofMethod method : kMethods) {
    for (const bool infill : {false, true}) {
      DofConfig config = config_of(method);
      config.infill = infill;
      EXPECT_THROW((void)depth_of_field(DepthPicture{}, config), ShapeError);
      DepthPicture picture = plane(9, 7, 2);
      picture.front.depth[3] = -2;
      EXPECT_THROW((void)depth_of_field(picture, config), ValueError);
      config.lens.focus_distance_m = 0.04;
      EXPECT_THROW((void)depth_of_field(plane(9, 7, 2), config), ValueError);
    }
  }
}

TEST(DepthOfField, LongWorkHearsThatItShouldStop) {
  class Stopped : public Progress {
   public:
    [[nodiscard]] bool cancelled() const override { return true; }
  } stopped;
  for (const DofMethod method : {DofMethod::kLayered, DofMethod::kSpread}) {
    EXPECT_THROW((void)depth_of_field(foreground(), config_of(method), stopped), Cancelled);
  }
}

TEST(DepthOfField, AwkwardSizesWork) {
  for (const auto& [width, height] : {std::pair{1U, 1U}, {1U, 300U}, {300U, 1U}, {49U, 2U}}) {
    for (const DofMethod method : kMethods) {
      DofConfig config = config_of(method);
      config.infill = true;
      for (const Rgba& c : depth_of_field(plane(width, height, 9), config))
        ASSERT_NEAR(c.b, 1, 1e-5F);
    }
  }
}

}  // namespace
}  // namespace relumbre
