#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "relumbre/scene/builtin_room.h"

namespace relumbre {

namespace {

Rect inset(const Rect& r, float by) { return {r.u0 + by, r.v0 + by, r.u1 - by, r.v1 - by}; }

/// Three bands of colour in a mount in a frame.
struct Print {
  const char* name;
  std::array<Rgb, 3> bands;   ///< from the bottom
  std::array<float, 2> cuts;  ///< where they meet, as fractions of the height
};

struct PictureMaterials {
  std::uint32_t frame, mount;
};

/// `across` is true where the plane's u axis is horizontal.
void add_picture(SceneBuilder& builder, const Plane& wall, const Rect& outline, bool across,
                 const Print& print, const PictureMaterials& materials) {
  constexpr float kDepth = 0.028F, kSheet = 0.014F, kFrame = 0.020F, kMount = 0.055F;
  builder.begin_object(print.name);
  builder.use(materials.frame);
  add_frame(builder, wall, {outline, inset(outline, kFrame), 0, kDepth, true, false});
  builder.use(materials.mount);
  const Rect sheet = inset(outline, kFrame), image = inset(outline, kFrame + kMount);
  add_panel(builder, wall, sheet, std::array{image}, kSheet);
  for (std::size_t i = 0; i < 3; ++i) {
    builder.use(builder.add_matt(std::string(print.name) + " band " + std::to_string(i + 1),
                                 print.bands[i]));
    const float from = i == 0 ? 0 : print.cuts[i - 1], to = i == 2 ? 1 : print.cuts[i];
    Rect band = image;
    float& low = across ? band.v0 : band.u0;
    float& high = across ? band.v1 : band.u1;
    const float start = low, extent = high - low;
    low = start + from * extent;
    high = start + to * extent;
    add_panel(builder, wall, band, {}, kSheet);
  }
}

void add_pictures(SceneBuilder& builder, const RoomPalette& palette) {
  const Plane north{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, west{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const PictureMaterials materials{palette.metal, palette.porcelain};
  const std::array<Print, 3> prints{
      {{"picture 1",
        {{{0.10F, 0.22F, 0.20F}, {0.32F, 0.42F, 0.32F}, {0.76F, 0.68F, 0.50F}}},
        {0.30F, 0.52F}},
       {"picture 2",
        {{{0.07F, 0.13F, 0.28F}, {0.18F, 0.38F, 0.50F}, {0.80F, 0.52F, 0.25F}}},
        {0.38F, 0.62F}},
       {"picture 3",
        {{{0.34F, 0.20F, 0.12F}, {0.66F, 0.46F, 0.20F}, {0.62F, 0.70F, 0.72F}}},
        {0.25F, 0.45F}}}};
  for (std::size_t i = 0; i < prints.size(); ++i)
    add_picture(builder, north, kNorthPictures[i], true, prints[i], materials);
  add_picture(builder, west, kWestPicture, false,
              {"picture 4",
               {{{0.12F, 0.16F, 0.26F}, {0.55F, 0.18F, 0.12F}, {0.80F, 0.62F, 0.34F}}},
               {0.42F, 0.55F}},
              materials);
}

/// A thin leaf, two-sided, that leaves the pot steeply and bends over; its midrib is a parabola.
struct Leaf {
  float yaw_deg, length, rise, half_width;
};
void add_leaf(SceneBuilder& builder, const Leaf& leaf) {
  constexpr int kSteps = 8;
  std::vector<Vec3f> points, normals;
  std::vector<Index3> triangles;
  for (int i = 0; i <= kSteps; ++i) {
    const float t = static_cast<float>(i) / kSteps;
    const float reach = leaf.length * (0.25F * t + 0.75F * t * t);
    const float height = leaf.rise * (1.9F * t - 1.05F * t * t);
    const float half = leaf.half_width * std::sin(std::numbers::pi_v<float> * std::pow(t, 0.8F)) +
                       0.003F * (1 - t);
    const Vec3f tangent{leaf.length * (0.25F + 1.5F * t), leaf.rise * (1.9F - 2.1F * t), 0};
    const Vec3f normal = normalized(Vec3f(-tangent.y, tangent.x, 0));
    for (const float side : {1.0F, -1.0F}) {
      points.push_back({reach, height, i == kSteps ? 0 : side * half});
      normals.push_back(normal);
    }
    if (i == 0) continue;
    const auto a = static_cast<std::uint32_t>(2 * i - 2);
    triangles.insert(triangles.end(), {{a, a + 2, a + 3}, {a, a + 3, a + 1}});
  }
  const ScopedPlacement turned_leaf(builder, turned({}, leaf.yaw_deg));
  builder.surface(points, normals, triangles);
}

void add_plant(SceneBuilder& builder) {
  builder.begin_object("plant pot");
  builder.use(builder.add_matt("pot", {0.66F, 0.62F, 0.56F}));
  builder.place({kPlant});
  add_revolved(builder,
               std::array<Vec2f, 7>{{{0, 0.0005F},
                                     {0.105F, 0.0005F},
                                     {0.125F, 0.03F},
                                     {0.150F, 0.28F},
                                     {0.138F, 0.28F},
                                     {0.134F, 0.245F},
                                     {0, 0.245F}}},
               40);
  builder.begin_object("plant");
  Material leaves;
  leaves.name = "leaves";
  leaves.reflectance = {0.09F, 0.26F, 0.06F};
  leaves.two_sided = true;
  builder.use(builder.add_material(leaves));
  constexpr int kLeaves = 17;
  for (int i = 0; i < kLeaves; ++i) {
    // Successive leaves turn by the golden angle; the later ones stand steeper.
    const auto k = static_cast<float>(i);
    const float inner = k / kLeaves;
    const float yaw = 137.508F * k;
    const Vec3f foot = turned({}, yaw).vector({0.030F * (1 - inner) + 0.006F, 0, 0});
    const ScopedPlacement planted(builder, {foot + Vec3f(0, 0.246F, 0)});
    add_leaf(builder, {yaw, 0.24F - 0.14F * inner, 0.42F + 0.42F * inner, 0.040F});
  }
  builder.place({});
}

}  // namespace

void add_room_decor(SceneBuilder& builder, const RoomPalette& palette) {
  add_pictures(builder, palette);
  add_plant(builder);
}

}  // namespace relumbre
