// `relumbre render` through a lens and with a second layer, as a user meets them.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_folder.h"
#include "relumbre/image/image_io.h"
#include "relumbre/image/metrics.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {
namespace {

/// The teapots, baked once for all tests.
class RenderLensCli : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ProgramFolder;
    ASSERT_EQ(run("scene teapots -o t.glb"), 0) << read("err.txt");
    ASSERT_EQ(run("bake t.glb -o t.h5 --patches 200 --elements 4000 --rays 32"), 0)
        << read("err.txt");
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static int run(const std::string& arguments) { return folder_->run(arguments).status; }
  static int render(const std::string& options) {
    return run("render t.h5 --camera main --size 160x90 --mode gouraud --samples 16 " + options);
  }
  static nlohmann::json figures(const std::string& options) {
    EXPECT_EQ(render(options + " --json f.json"), 0) << read("err.txt");
    return nlohmann::json::parse(read("f.json"));
  }
  static int interrupt_after(int seconds, const std::string& arguments) {
    return folder_->run_and_interrupt(seconds, arguments).status;
  }
  static std::size_t files() { return folder_->files(); }
  static std::string read(const std::string& name) { return folder_->read(name); }
  static Image image(const std::string& name) { return folder_->image(name); }
  static bool exists(const std::string& name) { return folder_->exists(name); }
  static void expect_refused(const std::string& options, int status, const std::string& reason) {
    // Its light cache may have been written before.
    EXPECT_EQ(render(options + " -o refused.exr"), status) << options << read("err.txt");
    EXPECT_NE(read("err.txt").find(reason), std::string::npos) << read("err.txt");
    EXPECT_FALSE(exists("refused.exr"));
  }

 private:
  inline static ProgramFolder* folder_ = nullptr;
};

/// The lens of the paper's accumulated picture: a third of a metre across for the teapots' metres.
const char* const kLens = "--lens --focal-length 105 --f-number 1.4 --lens-samples 128 ";

TEST_F(RenderLensCli, TheTeapotInFocusIsTheSharpest) {
  ASSERT_EQ(render("-o pinhole.exr"), 0);
  const Image sharp = image("pinhole.exr");
  std::vector<std::uint8_t> plum;  // the last teapot
  for (std::size_t i = 0; i < sharp.pixels(); ++i) {
    const float red = sharp.channel("albedo.R")[i], green = sharp.channel("albedo.G")[i];
    plum.push_back(red > 2 * green && sharp.channel("albedo.B")[i] > 2 * green ? 1 : 0);
  }
  const auto error = [&](const std::string& focus) {
    const nlohmann::json json =
        figures(std::string(kLens) + "--focus-distance " + focus + " -o lens.exr -o lens.png");
    EXPECT_EQ(json["focus_distance_m"], std::stod(focus));
    const ThinLens lens{105, 1.4, std::stod(focus), 36};
    EXPECT_NEAR(json["coc_at_infinity_pixels"].get<double>(), lens.coc_at_infinity_pixels(160),
                1e-9);
    return mean_squared_error(sharp, image("lens.exr"), plum);
  };
  EXPECT_LT(4 * error("6.3"), error("2"));
  EXPECT_TRUE(exists("lens.png"));
}

TEST_F(RenderLensCli, DepthIsThePinholes) {
  ASSERT_EQ(render("-o pinhole.exr"), 0);
  ASSERT_EQ(render(std::string(kLens) + "--focus nearest -o lens.exr"), 0) << read("err.txt");
  const Image a = image("pinhole.exr"), b = image("lens.exr");
  EXPECT_TRUE(std::equal(a.channel("Z").begin(), a.channel("Z").end(), b.channel("Z").begin()));
}

TEST_F(RenderLensCli, FocusesWhereItIsTold) {
  ASSERT_EQ(render("-o pinhole.exr"), 0);
  const Image pinhole = image("pinhole.exr");
  const auto z = pinhole.channel("Z");
  const std::string lens = "--lens --lens-samples 2 -o lens.exr ";
  const auto focus = [&](const std::string& options) {
    return figures(lens + options)["focus_distance_m"].get<float>();
  };
  EXPECT_EQ(focus(""), z[45 * 160 + 80]);
  EXPECT_EQ(focus("--focus center"), z[45 * 160 + 80]);
  EXPECT_EQ(focus("--focus-pixel 70,55"), z[55 * 160 + 70]);
  EXPECT_EQ(focus("--focus nearest"), *std::min_element(z.begin(), z.end()));
}

TEST_F(RenderLensCli, BladesChangeThePicture) {
  const std::string lens = std::string(kLens) + "--focus-distance 2 ";
  ASSERT_EQ(render(lens + "-o disc.exr"), 0);
  ASSERT_EQ(render(lens + "--blades 6 --blade-rotation 15 -o hexagon.exr"), 0) << read("err.txt");
  EXPECT_GT(mean_squared_error(image("disc.exr"), image("hexagon.exr")), 0);
}

TEST_F(RenderLensCli, DirectLightPerPixelGoesThroughTheLensToo) {
  EXPECT_EQ(
      run("render t.h5 --camera main --size 40x30 --lens --lens-samples 16 --focus-distance 5 "
          "-o direct.exr"),
      0)
      << read("err.txt");
  for (const float v : image("direct.exr").channel("R")) EXPECT_TRUE(std::isfinite(v));
}

TEST_F(RenderLensCli, ASecondLayerLiesBehindTheFirst) {
  ASSERT_EQ(render("--layers 2 -o layers.exr"), 0) << read("err.txt");
  const Image layers = image("layers.exr");
  const auto z = layers.channel("Z"), behind = layers.channel("layer1.Z");
  const auto alpha = layers.channel("layer1.A");
  std::size_t found = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (std::isinf(behind[i])) continue;
    ++found;
    EXPECT_GT(behind[i], 1.0019F * z[i]);
    EXPECT_GT(alpha[i], 0);
  }
  EXPECT_GT(found, 100U);             // behind the teapots there is the table
  EXPECT_EQ(alpha[80 * 160 + 5], 0);  // below the table there is nothing
  EXPECT_TRUE(layers.has("layer1.R") && layers.has("layer1.G") && layers.has("layer1.B"));
}

TEST_F(RenderLensCli, LensesThatAreNoneAreRefused) {
  expect_refused("--lens --focus-distance 5 --f-number 0", 1, "f-number is 0");
  expect_refused("--lens --focus-distance 5 --f-number -2", 1, "f-number is -2");
  expect_refused("--lens --focus-distance 0.05", 1, "not beyond the focal length of 50 mm");
  expect_refused("--lens --focus-distance 0.01", 1, "not beyond the focal length of 50 mm");
  expect_refused("--lens --focus-distance nan", 1, "focus distance");
  expect_refused("--lens --focus-distance 5 --focal-length -50", 1, "focal length is -50 mm");
  expect_refused("--lens --focus-distance 5 --sensor-width 0", 1, "sensor");
  expect_refused("--lens --focus-distance 5 --blades 2", 1, "2 blades");
  expect_refused("--lens --focus-distance 5 --lens-samples 0", 1, "0 samples");
  expect_refused("--lens --focus-pixel 160,0", 1, "pixel 160,0 lies outside of 160 x 90");
}

TEST_F(RenderLensCli, OptionsThatContradictAreMisuse) {
  expect_refused("--lens --layers 2", 2, "--layers");
  expect_refused("--layers 3", 2, "--layers");
  expect_refused("--lens --focus-distance 5 --focus nearest", 2, "--focus");
  expect_refused("--lens --focus-distance 5 --focus-pixel 1,1", 2, "--focus");
  expect_refused("--lens --focus-pixel 1", 2, "--focus-pixel");
}

TEST_F(RenderLensCli, AnInterruptLeavesNothingHalfWritten) {
  // The store's light responses are kept beside it from the first picture on.
  ASSERT_EQ(run("render t.h5 --camera main --size 8x8 --mode gouraud -o small.exr"), 0);
  const auto before = files();
  const int status = interrupt_after(
      2,
      "render t.h5 --camera main --size 1920x1080 --mode gouraud --lens --focus-distance 5 "
      "--lens-samples 60000 -o interrupted.exr");
  EXPECT_EQ(status, 130) << read("err.txt");
  EXPECT_FALSE(exists("interrupted.exr"));
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace relumbre
