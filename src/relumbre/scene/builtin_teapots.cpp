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

/// The profile of a photographer's sweep, extruded along x: table, cove, backdrop.
void add_sweep(SceneBuilder& builder) {
  constexpr int kSteps = 16;
  constexpr float kBack = -3.2F, kRadius = 0.7F, kTop = 2.4F, kHalfWidth = 4.5F;
  builder.begin_object("table");
  builder.quad({-kHalfWidth, 0, 1.6F}, {kHalfWidth, 0, 1.6F}, {kHalfWidth, 0, kBack + kRadius},
               {-kHalfWidth, 0, kBack + kRadius});
  builder.begin_object("backdrop");
  std::vector<Vec3f> points, normals;
  std::vector<Index3> triangles;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const float angle =
        std::numbers::pi_v<float> / 2 * static_cast<float>(i) / static_cast<float>(kSteps);
    const Vec3f n{0, std::cos(angle), std::sin(angle)};
    for (const float x : {-kHalfWidth, kHalfWidth}) {
      points.push_back(Vec3f(x, kRadius, kBack + kRadius) - n * kRadius);
      normals.push_back(n);
    }
    if (i == 0) continue;
    const std::uint32_t a = 2 * i - 2;
    triangles.insert(triangles.end(), {{a, a + 1, a + 3}, {a, a + 3, a + 2}});
  }
  builder.surface(points, normals, triangles);
  builder.quad({-kHalfWidth, kRadius, kBack}, {kHalfWidth, kRadius, kBack},
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
    const auto step = static_cast<float>(i);
    builder.begin_object("teapot " + std::to_string(i + 1));
    builder.use(builder.add_matt(kGlazes[i].name, kGlazes[i].reflectance));
    builder.place(turned({-0.36F + 0.27F * step, 0, 0.06F - 0.34F * step}, 20));
    add_teapot(builder, 0.16F);
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
  builder.quad({-1.2F, 2, -1.8F}, {0.6F, 2, -1.8F}, {0.6F, 2, 0.6F}, {-1.2F, 2, 0.6F});
  builder.add_camera({"main", {-0.30F, 0.36F, 0.85F}, {0.03F, 0.05F, -0.45F}, {0, 1, 0}, 36});
  return std::move(builder).finish();
}

}  // namespace relumbre
