#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/scene_builder.h"
#include "relumbre/scene/shapes.h"
#include "relumbre/scene/teapot.h"

namespace relumbre {

namespace {

// What the paper's program draws with GLUT: the camera at the origin looks along −z. GLUT's teapot
// of size 0.5 is 0.25 · 3.15 high, and its position is 0.25 · 1.5 above its foot.
constexpr float kHeight = 0.25F * 3.15F;
constexpr float kFootBelow = 0.25F * 1.5F;
constexpr std::array<Vec3f, 5> kPositions{{{-1.1F, -0.5F, -4.5F},
                                           {-0.5F, -0.5F, -5.0F},
                                           {0.2F, -0.5F, -5.5F},
                                           {1.0F, -0.5F, -6.0F},
                                           {1.8F, -0.5F, -6.5F}}};
constexpr float kVerticalFieldOfView = 45;
/// So that no foot lies in the table's plane, where neither could be told to be in front.
constexpr float kGap = 5e-4F;
constexpr float kTable = -0.5F - kFootBelow - kGap;

/// The profile of a photographer's sweep, extruded along x: table, cove, backdrop.
void add_sweep(SceneBuilder& builder) {
  constexpr int kSteps = 16;
  constexpr float kFront = -1, kBack = -9.5F, kRadius = 1.5F, kTop = 4.4F, kHalfWidth = 8;
  builder.begin_object("table");
  builder.quad({-kHalfWidth, kTable, kFront}, {kHalfWidth, kTable, kFront},
               {kHalfWidth, kTable, kBack + kRadius}, {-kHalfWidth, kTable, kBack + kRadius});
  builder.begin_object("backdrop");
  std::vector<Vec3f> points, normals;
  std::vector<Index3> triangles;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const float angle =
        std::numbers::pi_v<float> / 2 * static_cast<float>(i) / static_cast<float>(kSteps);
    const Vec3f n{0, std::cos(angle), std::sin(angle)};
    for (const float x : {-kHalfWidth, kHalfWidth}) {
      points.push_back(Vec3f(x, kTable + kRadius, kBack + kRadius) - n * kRadius);
      normals.push_back(n);
    }
    if (i == 0) continue;
    const std::uint32_t a = 2 * i - 2;
    triangles.insert(triangles.end(), {{a, a + 1, a + 3}, {a, a + 3, a + 2}});
  }
  builder.surface(points, normals, triangles);
  builder.quad({-kHalfWidth, kTable + kRadius, kBack}, {kHalfWidth, kTable + kRadius, kBack},
               {kHalfWidth, kTop, kBack}, {-kHalfWidth, kTop, kBack});
}

void add_teapots(SceneBuilder& builder) {
  struct Glaze {
    const char* name;
    Rgb reflectance;
  };
  constexpr std::array<Glaze, 5> kGlazes{{{"ochre", {0.68F, 0.40F, 0.08F}},
                                          {"teal", {0.06F, 0.36F, 0.38F}},
                                          {"brick", {0.56F, 0.12F, 0.07F}},
                                          {"sage", {0.32F, 0.45F, 0.20F}},
                                          {"plum", {0.34F, 0.12F, 0.32F}}}};
  for (std::size_t i = 0; i < kGlazes.size(); ++i) {
    builder.begin_object("teapot " + std::to_string(i + 1));
    builder.use(builder.add_matt(kGlazes[i].name, kGlazes[i].reflectance));
    builder.place(turned(kPositions[i] - Vec3f{0, kFootBelow, 0}, 0));
    add_teapot(builder, kHeight);
  }
  builder.place({});
}

}  // namespace

Scene make_teapots_scene() {
  SceneBuilder builder;
  builder.use(builder.add_matt("paper", {0.72F, 0.71F, 0.69F}));
  add_sweep(builder);
  add_teapots(builder);
  builder.begin_object("soft box");
  builder.use(builder.add_glowing("soft box", {30, 28, 25}));
  builder.quad({-2.5F, 3, -6.5F}, {1.5F, 3, -6.5F}, {1.5F, 3, -3.5F}, {-2.5F, 3, -3.5F});
  builder.add_camera({"main", {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kVerticalFieldOfView});
  return std::move(builder).finish();
}

}  // namespace relumbre
