// `relumbre dof`, as a user meets it.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "dof_cli_fixture.h"
#include "relumbre/image/metrics.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {
namespace {

/// The teapots, with what lies behind them and without, made once for all tests.
class DofCli : public DofFixture {
 protected:
  static void SetUpTestSuite() {
    DofFixture::SetUpTestSuite();
    ASSERT_EQ(run("scene teapots -o t.glb"), 0) << read("err.txt");
    ASSERT_EQ(run("bake t.glb -o t.h5 --patches 200 --elements 4000 --rays 32"), 0)
        << read("err.txt");
    const std::string view = "render t.h5 --camera main --size 160x90 --mode gouraud --samples 16 ";
    ASSERT_EQ(run(view + "--layers 2 -o layers.exr"), 0) << read("err.txt");
    ASSERT_EQ(run(view + "-o flat.exr"), 0) << read("err.txt");
    ASSERT_EQ(run(view + kLens + "--lens --lens-samples 256 -o lens.exr"), 0) << read("err.txt");
  }

  static nlohmann::json figures(const std::string& arguments) {
    EXPECT_EQ(dof(arguments + " --json f.json"), 0) << arguments << read("err.txt");
    return nlohmann::json::parse(read("f.json"));
  }

  static inline const std::string kLens = "--focal-length 200 --f-number 1.4 --focus-distance 5 ";
};

void expect_equal(const Image& a, const Image& b, float tolerance = 0) {
  for (const char* name : {"R", "G", "B", "A"}) {
    const auto x = a.channel(name), y = b.channel(name);
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i], y[i], tolerance) << name << i;
  }
}

TEST_F(DofCli, EveryMethodAndShapeMakesAPicture) {
  for (const std::string options :
       {"--method gather", "--method layered", "--method layered --infill --layers 12",
        "--method spread", "--shape disc", "--shape hexagon", "--shape octagon", "--shape box",
        "--blades 5", "--blades 7 --blade-rotation 12", "--shape hexagon --blade-rotation 30",
        "--infill", "--layers 3", "--max-blur 6"}) {
    for (const std::string input : {"layers.exr", "flat.exr"}) {
      ASSERT_EQ(dof(input + " " + kLens + options + " -o a.exr"), 0) << options << read("err.txt");
      const Image result = image("a.exr");
      EXPECT_EQ(result.width(), 160U);
      EXPECT_EQ(result.height(), 90U);
      for (const char* name : {"R", "G", "B", "A"})
        for (const float v : result.channel(name)) ASSERT_TRUE(std::isfinite(v)) << options;
      EXPECT_GT(mean_squared_error(image("flat.exr"), result), 0) << options;
    }
  }
}

TEST_F(DofCli, SpreadIsNearerToTheLensThanGather) {
  const auto missing = [](const std::string& file) {
    return 1 - compare_images(image("lens.exr"), image(file)).ssim_luminance;
  };
  const auto missing_with = [&](const std::string& options) {
    EXPECT_EQ(dof("layers.exr " + kLens + options + " -o a.exr"), 0) << read("err.txt");
    return missing("a.exr");
  };
  const double gather = missing_with("--method gather"), spread = missing_with("--method spread");
  EXPECT_LT(2 * spread, gather);
  EXPECT_LT(2 * spread, missing("flat.exr"));
}

TEST_F(DofCli, ShapesAndRotationsDiffer) {
  const auto picture = [](const std::string& options) {
    EXPECT_EQ(dof("layers.exr --focal-length 105 --focus-distance 2 " + options + " -o a.exr"), 0);
    return read("a.exr");
  };
  const std::string disc = picture("--shape disc"), hexagon = picture("--shape hexagon"),
                    octagon = picture("--shape octagon"), box = picture("--shape box"),
                    turned = picture("--shape hexagon --blade-rotation 30");
  EXPECT_NE(disc, hexagon);
  EXPECT_NE(hexagon, octagon);
  EXPECT_NE(octagon, box);
  EXPECT_NE(hexagon, turned);
  EXPECT_EQ(hexagon, picture("--blades 6"));
  EXPECT_EQ(octagon, picture("--blades 8"));
  EXPECT_EQ(disc, picture(""));
}

TEST_F(DofCli, FocusesWhereItIsTold) {
  const Image pinhole = image("flat.exr");
  const auto z = pinhole.channel("Z");
  const auto focus = [](const std::string& options) {
    return figures("flat.exr --method gather -o a.exr " + options)["focus_m"].get<float>();
  };
  EXPECT_EQ(focus("--focus-distance 3.25"), 3.25F);
  EXPECT_EQ(focus("--focus-pixel 70,55"), z[55 * 160 + 70]);
  EXPECT_EQ(focus("--focus-pixel 80,45"), z[45 * 160 + 80]);
  const float middle = focus("");
  EXPECT_NE(std::ranges::find(z, middle), z.end());
}

TEST_F(DofCli, FiguresSayHowMuchIsBlurred) {
  const nlohmann::json json = figures("layers.exr " + kLens + "-o a.exr");
  const ThinLens lens{200, 1.4, 5, 36};
  const Image pinhole = image("layers.exr");
  const auto z = pinhole.channel("Z");
  double before = 0, behind = 0;
  for (const float depth : z) {
    const double c = lens.signed_coc_diameter_pixels(static_cast<double>(depth), 160);
    before = std::max(before, -c), behind = std::max(behind, c);
  }
  EXPECT_EQ(json["focus_m"], 5);
  EXPECT_NEAR(json["coc_before_px"].get<double>(), before, 1e-3);
  EXPECT_NEAR(json["coc_behind_px"].get<double>(), behind, 1e-3);
  EXPECT_GE(json["seconds"].get<double>(), 0);
}

TEST_F(DofCli, FiguresSayWhereWhatLiesBehindIsFrom) {
  const auto source = [](const std::string& options) {
    return figures(kLens + "-o a.exr " + options)["second_layer"].get<std::string>();
  };
  EXPECT_EQ(source("layers.exr"), "read");
  EXPECT_EQ(source("layers.exr --infill"), "read");
  EXPECT_EQ(source("flat.exr --infill"), "guessed");
  EXPECT_EQ(source("flat.exr"), "unknown");
  EXPECT_EQ(source("layers.exr --method gather"), "not used");
}

TEST_F(DofCli, InfillLeavesASecondLayerAsItIs) {
  ASSERT_EQ(dof("layers.exr " + kLens + "-o a.exr"), 0);
  ASSERT_EQ(dof("layers.exr " + kLens + "--infill -o b.exr"), 0);
  EXPECT_EQ(read("a.exr"), read("b.exr"));
  ASSERT_EQ(dof("flat.exr " + kLens + "-o a.exr"), 0);
  ASSERT_EQ(dof("flat.exr " + kLens + "--infill -o b.exr"), 0);
  EXPECT_NE(read("a.exr"), read("b.exr"));
}

TEST_F(DofCli, WritesSeveralPicturesAndAnOverlay) {
  ASSERT_EQ(dof("flat.exr " + kLens +
                "-o two.exr -o two.PNG --overlay over.png --exposure 1 "
                "--curve srgb --json f.json"),
            0)
      << read("err.txt");
  EXPECT_EQ(image("two.exr").width(), 160U);
  EXPECT_EQ(image("two.PNG").width(), 160U);
  EXPECT_EQ(image("over.png").width(), 160U);
  ASSERT_EQ(dof("flat.exr " + kLens + "-o two.exr --overlay over.exr"), 0) << read("err.txt");
  const Image overlay = image("over.exr"), pinhole = image("flat.exr");
  for (std::size_t i = 0; i < overlay.pixels(); ++i) {
    const float z = pinhole.channel("Z")[i];
    const Rgb c = overlay.rgb(i);
    if (z < 4) {
      EXPECT_GE(c.x, c.z);
    }
    if (z > 7) {
      EXPECT_GE(c.z, c.x);
    }
  }
}

TEST_F(DofCli, DoesNotDependOnTheNumberOfThreads) {
  for (const std::string method : {"gather", "layered", "spread"}) {
    ASSERT_EQ(dof("flat.exr --infill " + kLens + "--method " + method + " -o a.exr"), 0);
    ASSERT_EQ(dof("flat.exr --infill " + kLens + "--threads 1 --method " + method + " -o b.exr"),
              0);
    EXPECT_EQ(read("a.exr"), read("b.exr")) << method;
  }
}

TEST_F(DofCli, ReadsWhatOthersWrite) {
  const Image plain = noise(37, 23);
  const std::string lens = " --focus-distance 3 -o ";
  ASSERT_EQ(dof("small.exr" + lens + "plain.exr"), 0) << read("err.txt");
  const std::vector<std::vector<std::string>> names{
      {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
       "ViewLayer.Combined.A", "ViewLayer.Depth.Z"},
      {"V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Combined.A", "V.Depth.V"}};
  for (const auto& channels : names) {
    save("other.exr", renamed(plain, channels));
    ASSERT_EQ(dof("other.exr" + lens + "other-dof.exr"), 0) << read("err.txt");
    EXPECT_EQ(read("other-dof.exr"), read("plain.exr"));
  }
  save("other.exr", renamed(plain, {"fog.R", "fog.G", "fog.B", "fog.A", "far"}));
  ASSERT_EQ(dof("other.exr --color fog. --depth far" + lens + "other-dof.exr"), 0);
  EXPECT_EQ(read("other-dof.exr"), read("plain.exr"));
}

TEST_F(DofCli, StraightAlphaIsMultipliedIn) {
  Image straight = noise(37, 23), premultiplied = straight;
  for (std::size_t i = 0; i < straight.pixels(); ++i) {
    const float alpha = i % 3 == 0 ? 0.5F : 1;
    straight.channel("A")[i] = premultiplied.channel("A")[i] = alpha;
    for (const char* name : {"R", "G", "B"}) premultiplied.channel(name)[i] *= alpha;
  }
  save("straight.exr", straight);
  save("premultiplied.exr", premultiplied);
  ASSERT_EQ(dof("straight.exr --straight-alpha --focus-distance 3 -o a.exr"), 0);
  ASSERT_EQ(dof("premultiplied.exr --focus-distance 3 -o b.exr"), 0);
  EXPECT_EQ(read("a.exr"), read("b.exr"));
}

TEST_F(DofCli, RadialDepthIsMadePlanar) {
  const Image planar = noise(37, 23);
  const auto radial = [&](double pixels_per_tangent) {
    Image result = planar;
    for (std::size_t i = 0; i < result.pixels(); ++i) {
      const double x = (static_cast<double>(i % 37) - 18) / pixels_per_tangent,
                   y = (static_cast<double>(i / 37) - 11) / pixels_per_tangent;
      result.channel("Z")[i] *= static_cast<float>(std::sqrt(1 + x * x + y * y));
    }
    return result;
  };
  ASSERT_EQ(dof("small.exr --focus-distance 3 -o a.exr"), 0);
  save("radial.exr", radial(37 * 50.0 / 36));
  ASSERT_EQ(dof("radial.exr --radial --focus-distance 3 -o b.exr"), 0);
  expect_equal(image("a.exr"), image("b.exr"), 0.02F);
  save("radial.exr", radial(11.5 / std::tan(30 * std::numbers::pi / 180)));
  ASSERT_EQ(dof("radial.exr --radial --vfov 60 --focus-distance 3 -o b.exr"), 0);
  expect_equal(image("a.exr"), image("b.exr"), 0.02F);
}

TEST_F(DofCli, AwkwardSizesWork) {
  for (const auto& [width, height] : {std::pair{1U, 1U}, {1U, 97U}, {97U, 1U}, {2U, 2U}}) {
    save("awkward.exr", noise(width, height));
    for (const std::string options :
         {"--method gather", "--method layered --infill", "--infill", "--shape box --infill"}) {
      ASSERT_EQ(dof("awkward.exr -o a.exr --overlay b.exr " + options), 0) << read("err.txt");
      EXPECT_EQ(image("a.exr").width(), width);
      EXPECT_EQ(image("a.exr").height(), height);
    }
  }
}

TEST_F(DofCli, BlursBeyondTheLargestAreAsLargeAsThat) {
  for (const std::string options : {"", " --shape box", " --method layered", " --method gather"}) {
    const nlohmann::json json =
        figures("small.exr --f-number 0.001 --focus-distance 3 --max-blur 64 -o a.exr" + options);
    EXPECT_EQ(json["coc_before_px"], 64);
    EXPECT_EQ(json["coc_behind_px"], 64);
  }
}

}  // namespace
}  // namespace relumbre
