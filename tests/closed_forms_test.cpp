// Closed-form view factors through the program, with 10⁶ rays a surface.

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/temporary_folder.h"

namespace relumbre {
namespace {

/// An OBJ of named, one-sided polygons.
class Obj {
 public:
  void object(const std::string& name) { text_ += "o " + name + "\n"; }
  void polygon(const std::vector<std::array<double, 3>>& corners) {
    std::string face = "f";
    for (const auto& c : corners) {
      text_ += fmt::format("v {:.17g} {:.17g} {:.17g}\n", c[0], c[1], c[2]);
      face += fmt::format(" {}", ++vertices_);
    }
    text_ += face + "\n";
  }
  /// A disc at height z that faces up or down, as a fan of thin triangles.
  void disc(double radius, double z, bool up) {
    constexpr int kSides = 720;
    // The polygon has the disc's area: its corners lie a little outside.
    const double step = 2 * std::numbers::pi / kSides,
                 r = radius * std::sqrt(step / std::sin(step));
    for (int i = 0; i < kSides; ++i) {
      const double a = i * step, b = (i + 1) * step;
      const std::array<double, 3> p = {r * std::cos(a), r * std::sin(a), z},
                                  q = {r * std::cos(b), r * std::sin(b), z};
      up ? polygon({{0, 0, z}, p, q}) : polygon({{0, 0, z}, q, p});
    }
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::size_t vertices_ = 0;
};

struct Factor {
  double value, error;
};

Factor view_factor(const Obj& obj, const std::string& from, const std::string& to) {
  const TemporaryFolder folder;
  write_file(folder.path() / "scene.obj", obj.text());
  const std::string command = fmt::format(
      "cd '{}' && {} viewfactors scene.obj --sides one --rays 1000000 --json f.json >/dev/null",
      folder.path().string(), RELUMBRE_PROGRAM);
  EXPECT_EQ(std::system(command.c_str()), 0);
  const auto json = nlohmann::json::parse(read_file(folder.path() / "f.json"));
  for (const auto& pair : json["view_factors"]) {
    if (pair["from"] == from && pair["to"] == to) return {pair["factor"], pair["standard_error"]};
  }
  ADD_FAILURE() << "no pair " << from << ", " << to;
  return {};
}

void expect_factor(const Factor& factor, double exact) {
  EXPECT_NEAR(factor.value, exact, 1e-3);
  EXPECT_NEAR(factor.value, exact, 4 * factor.error) << "standard error " << factor.error;
  EXPECT_GT(factor.error, 0);
}

void add_parallel_squares(Obj& obj) {
  obj.object("low");
  obj.polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  obj.object("high");
  obj.polygon({{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}});
}

TEST(ViewFactorsClosedForm, ParallelSquares) {
  Obj obj;
  add_parallel_squares(obj);
  expect_factor(view_factor(obj, "low", "high"), 0.199824895698);
}

/// w along the common edge's normal in the base, h up, common edge of length 1.
double perpendicular(double h, double w) {
  Obj obj;
  obj.object("base");
  obj.polygon({{0, 0, 0}, {w, 0, 0}, {w, 1, 0}, {0, 1, 0}});
  obj.object("wall");
  obj.polygon({{0, 0, 0}, {0, 1, 0}, {0, 1, h}, {0, 0, h}});
  const Factor factor = view_factor(obj, "base", "wall");
  const double s = 1 + w * w + h * h, a = (1 + w * w) * (1 + h * h) / s,
               b = w * w * s / ((1 + w * w) * (w * w + h * h)),
               c = h * h * s / ((1 + h * h) * (w * w + h * h)), r = std::sqrt(h * h + w * w);
  const double exact = (w * std::atan(1 / w) + h * std::atan(1 / h) - r * std::atan(1 / r) +
                        0.25 * std::log(a * std::pow(b, w * w) * std::pow(c, h * h))) /
                       (std::numbers::pi * w);
  expect_factor(factor, exact);
  return exact;
}

TEST(ViewFactorsClosedForm, PerpendicularSquares) {
  EXPECT_NEAR(perpendicular(1, 1), 0.200043776075, 1e-12);
}
TEST(ViewFactorsClosedForm, PerpendicularRectangles) {
  EXPECT_NEAR(perpendicular(2, 1), 0.232852602795, 1e-12);
}

TEST(ViewFactorsClosedForm, CoaxialDiscs) {
  Obj obj;
  obj.object("low");
  obj.disc(1, 0, true);
  obj.object("high");
  obj.disc(1, 1, false);
  expect_factor(view_factor(obj, "low", "high"), 0.381966011250);
}

TEST(ViewFactorsClosedForm, HalfSizeOccluderInTheCorner) {
  Obj obj;
  add_parallel_squares(obj);
  obj.object("between");
  obj.polygon({{0, 0, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0.5}, {0, 0.5, 0.5}});
  expect_factor(view_factor(obj, "low", "high"), 0.149868671774);
}

TEST(ViewFactorsClosedForm, InsideSphereFactorIsAreaFraction) {
  // Two hemispheres of a sphere seen from inside: a quarter-degree error of the facets' tilt does
  // not matter to F = A_j / 4πR², which for equal halves is ½.
  Obj obj;
  constexpr int kBands = 64, kSectors = 128;
  const auto point = [](int band, int sector) -> std::array<double, 3> {
    const double t = std::numbers::pi * band / kBands, p = 2 * std::numbers::pi * sector / kSectors;
    return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
  };
  for (int band = 0; band < kBands; ++band) {
    if (band == 0) obj.object("top");
    if (band == kBands / 2) obj.object("bottom");
    for (int s = 0; s < kSectors; ++s) {
      if (band > 0) obj.polygon({point(band, s), point(band, s + 1), point(band + 1, s + 1)});
      if (band < kBands - 1)
        obj.polygon({point(band, s), point(band + 1, s + 1), point(band + 1, s)});
    }
  }
  const Factor factor = view_factor(obj, "top", "bottom");
  EXPECT_NEAR(factor.value, 0.5, 1e-3);
}

}  // namespace
}  // namespace relumbre
