// `relumbre compare` as a user meets it: figures, bands around silhouettes, FLIP maps, refusals.

#include <filesystem>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_folder.h"
#include "relumbre/base/sampling.h"
#include "relumbre/image/image_io.h"
#include "relumbre/image/metrics.h"
#include "relumbre/image/png.h"

namespace relumbre {
namespace {

class CompareCli : public testing::Test {
 protected:
  /// Runs `relumbre compare ARGUMENTS` in the test's folder; returns its exit status.
  int run(const std::string& arguments) const { return folder_.run("compare " + arguments).status; }
  nlohmann::json figures(const std::string& arguments) const {
    EXPECT_EQ(run(arguments + " --json f.json"), 0) << read("err.txt");
    return nlohmann::json::parse(read("f.json"));
  }
  std::string read(const std::string& name) const { return folder_.read(name); }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  bool exists(const std::string& name) const { return folder_.exists(name); }
  void save(const std::string& name, const Image& image) const {
    save_image(folder_ / name, image, {.curve = ToneCurve::kSrgb});
  }
  void expect_refused(const std::string& arguments, int status, const std::string& reason) const {
    folder_.expect_refused("compare " + arguments, {reason}, status);
  }

 private:
  ProgramFolder folder_;
};

/// Noise around a grey, with a depth that jumps between the left and the right half.
Image picture(std::uint64_t seed) {
  Image image = rgb_image(40, 30);
  RandomStream random(seed);
  const std::span<float> z = image.add("Z");
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    image.set_rgb(i, Rgb(0.3F + 0.4F * random.uniform()));
    z[i] = i % 40 < 20 ? 2.0F : std::numeric_limits<float>::infinity();
  }
  return image;
}

TEST_F(CompareCli, EqualImagesHaveNoFlipError) {
  save("a.exr", picture(1));
  const nlohmann::json json = figures("a.exr a.exr");
  EXPECT_EQ(json["flip"]["mean"], 0);
  EXPECT_EQ(json["flip"]["kind"], "HDR");
  EXPECT_EQ(json["linear"]["ssim_rgb"], 1);
  EXPECT_NEAR(json["flip"]["pixels_per_degree"].get<double>(), 67.0206, 1e-4);
  EXPECT_FALSE(json.contains("band"));
}

TEST_F(CompareCli, DisplayedImagesAreComparedAsStored) {
  save("a.png", picture(1));
  save("b.png", picture(2));
  const nlohmann::json json = figures("a.png b.png");
  EXPECT_EQ(json["flip"]["kind"], "LDR");
  EXPECT_GT(json["flip"]["mean"].get<double>(), 0.01);
  EXPECT_FALSE(json["flip"].contains("exposures"));
}

TEST_F(CompareCli, FlipCanBeLeftOut) {
  save("a.exr", picture(1));
  EXPECT_FALSE(figures("a.exr a.exr --no-flip --band 2").contains("flip"));
  expect_refused("a.exr a.exr --no-flip --flip-map m.png", 2, "--flip-map");
}

TEST_F(CompareCli, BandHoldsThePixelsAroundTheJump) {
  save("a.exr", picture(1));
  Image b = picture(1);
  b.set_rgb(3, Rgb(5.0F));  // far from the jump
  save("b.exr", b);
  const nlohmann::json json = figures("a.exr b.exr --band 2");
  EXPECT_EQ(json["band"]["pixels"], 6 * 30);
  EXPECT_NEAR(json["band"]["fraction"].get<double>(), 0.15, 1e-12);
  EXPECT_EQ(json["linear_band"]["mse"], 0);
  EXPECT_TRUE(json["display_band"]["psnr_db"].is_null());
  EXPECT_EQ(json["display_band"]["ssim_luminance"], 1);
  EXPECT_GT(json["linear"]["mse"].get<double>(), 0);
  EXPECT_LT(json["band"]["flip"].get<double>(), json["flip"]["mean"].get<double>());
}

TEST_F(CompareCli, BandTakesTheDepthFromEitherFile) {
  save("a.exr", picture(1));
  save("b.png", picture(2));
  EXPECT_EQ(figures("b.png a.exr --band 2")["band"]["pixels"], 6 * 30);
  EXPECT_EQ(figures("a.exr b.png --band 2")["band"]["pixels"], 6 * 30);
}

TEST_F(CompareCli, BandWithoutSilhouettesHasNoFigures) {
  Image flat = picture(1);
  for (float& z : flat.channel("Z")) z = 3;
  save("a.exr", flat);
  const nlohmann::json json = figures("a.exr a.exr --band 2");
  EXPECT_EQ(json["band"]["pixels"], 0);
  EXPECT_TRUE(json["band"]["flip"].is_null());
  EXPECT_TRUE(json["linear_band"]["ssim_rgb"].is_null());
}

TEST_F(CompareCli, FlipMapIsAPictureOfTheSameSize) {
  save("a.exr", picture(1));
  save("b.exr", picture(2));
  EXPECT_EQ(run("a.exr b.exr --flip-map m.png"), 0) << read("err.txt");
  const Raster map = read_png(path("m.png"));
  EXPECT_EQ(map.width, 40U);
  EXPECT_EQ(map.height, 30U);
}

TEST_F(CompareCli, BadInputIsRefusedByName) {
  save("a.exr", picture(1));
  save("a.png", picture(1));
  save("small.exr", rgb_image(9, 9));
  expect_refused("a.png a.png --band 3", 1, "a.png: --band needs a channel Z");
  expect_refused("a.exr small.exr", 1, "40 x 30");
  expect_refused("a.exr a.exr --band -1", 1, "radius of -1");
  expect_refused("a.exr a.exr --band-jump 0 --band 1", 1, "relative jump of 0");
  expect_refused("a.exr a.exr --ppd 0", 1, "pixels per degree");
  expect_refused("a.exr a.exr --flip-map m.exr", 2, "must end in .png");
  EXPECT_FALSE(exists("m.exr"));
  EXPECT_FALSE(exists("m.png"));
}

}  // namespace
}  // namespace relumbre
