#include <array>
#include <string>

#include "relumbre/scene/builtin_room.h"

namespace relumbre {

namespace {

/// About 15 W a bulb of 4.5 cm radius, in the tint of a warm lamp.
constexpr Rgb kWarm{760, 560, 330};
constexpr float kBulbRadius = 0.045F;
constexpr int kBulbSegments = 16;

void add_bulb(SceneBuilder& builder, const std::string& name, std::uint32_t glow,
              const Vec3f& center, float radius) {
  builder.begin_object(name);
  builder.use(glow);
  add_sphere(builder, center, radius, kBulbSegments);
}

/// A truncated cone of thin cloth that reflects on both sides.
void add_cloth_shade(SceneBuilder& builder, std::uint32_t cloth, float radius_low, float y_low,
                     float radius_high, float y_high) {
  builder.use(cloth);
  add_revolved(builder, std::array<Vec2f, 2>{{{radius_low, y_low}, {radius_high, y_high}}}, 48);
}

/// Over the dining table, on a cord from the ceiling: a dome of spun metal, white inside.
void add_pendant(SceneBuilder& builder, const RoomPalette& palette, std::uint32_t glow) {
  constexpr float kLip = 1.60F;
  builder.place({kDiningCenter});
  builder.begin_object("pendant shade");
  builder.use(builder.add_matt("pendant enamel", {0.55F, 0.24F, 0.13F}));
  add_revolved(builder,
               std::array<Vec2f, 9>{{{0.230F, kLip},
                                     {0.226F, kLip + 0.045F},
                                     {0.208F, kLip + 0.092F},
                                     {0.175F, kLip + 0.135F},
                                     {0.130F, kLip + 0.168F},
                                     {0.080F, kLip + 0.188F},
                                     {0.034F, kLip + 0.196F},
                                     {0.030F, kLip + 0.240F},
                                     {0.0F, kLip + 0.244F}}},
               44);
  builder.use(palette.porcelain);
  add_revolved(builder,
               std::array<Vec2f, 8>{{{0.0F, kLip + 0.190F},
                                     {0.075F, kLip + 0.183F},
                                     {0.125F, kLip + 0.163F},
                                     {0.170F, kLip + 0.131F},
                                     {0.203F, kLip + 0.089F},
                                     {0.221F, kLip + 0.044F},
                                     {0.225F, kLip},
                                     {0.230F, kLip}}},
               44);
  builder.use(palette.metal);
  add_leg(builder, {0, kLip + 0.2435F, 0}, {0, kRoomHeight - 0.02F, 0}, 0.004F, 0.004F, 10);
  add_revolved(builder,
               std::array<Vec2f, 3>{
                   {{0, kRoomHeight - 0.03F}, {0.045F, kRoomHeight - 0.02F}, {0.05F, kRoomHeight}}},
               32);
  add_bulb(builder, "pendant lamp", glow, {0, kLip + 0.085F, 0}, kBulbRadius);
  builder.place({});
}

/// Between sofa and shelf.
void add_floor_lamp(SceneBuilder& builder, const RoomPalette& palette, std::uint32_t glow,
                    std::uint32_t cloth) {
  constexpr float kShadeLow = 1.38F;
  builder.place({{3.235F, 0, 0.36F}});
  builder.begin_object("floor lamp stand");
  builder.use(palette.metal);
  add_revolved(builder,
               std::array<Vec2f, 6>{{{0.135F, 0},
                                     {0.135F, 0.014F},
                                     {0.120F, 0.022F},
                                     {0.020F, 0.030F},
                                     {0.011F, 0.050F},
                                     {0.011F, kShadeLow + 0.07F}}},
               40);
  add_revolved(builder,
               std::array<Vec2f, 4>{{{0.011F, kShadeLow + 0.07F},
                                     {0.020F, kShadeLow + 0.07F},
                                     {0.020F, kShadeLow + 0.105F},
                                     {0, kShadeLow + 0.105F}}},
               24);
  builder.begin_object("floor lamp shade");
  add_cloth_shade(builder, cloth, 0.215F, kShadeLow, 0.135F, kShadeLow + 0.29F);
  add_bulb(builder, "floor lamp", glow, {0, kShadeLow + 0.155F, 0}, kBulbRadius);
  builder.place({});
}

/// A jointed reading lamp on the side table, its head turned down towards the sofa.
void add_desk_lamp(SceneBuilder& builder, const RoomPalette& palette, std::uint32_t glow) {
  const Vec3f foot = kSideTable + Vec3f(-0.06F, kSideTableHeight + 0.0005F, -0.03F);
  builder.place(turned(foot, -20));
  builder.begin_object("desk lamp stand");
  builder.use(palette.metal);
  add_revolved(
      builder,
      std::array<Vec2f, 5>{{{0, 0}, {0.085F, 0}, {0.085F, 0.012F}, {0.075F, 0.020F}, {0, 0.024F}}},
      36);
  const Vec3f elbow{-0.10F, 0.29F, 0}, wrist{0.11F, 0.45F, 0};
  add_bar(builder, {0, 0.0245F, 0}, elbow + Vec3f(0.003F, -0.01F, 0), 0.008F, 0.008F, 12);
  add_sphere(builder, elbow, 0.0105F, 12);
  add_bar(builder, elbow + Vec3f(0.009F, 0.007F, 0), wrist, 0.007F, 0.007F, 12);
  // The head's +y axis points back up from where it shines.
  builder.place(builder.placement() * along(wrist, normalized(Vec3f(-0.42F, 1, 0))));
  builder.begin_object("desk lamp shade");
  builder.use(builder.add_matt("desk lamp enamel", {0.10F, 0.30F, 0.26F}));
  add_revolved(
      builder,
      std::array<Vec2f, 5>{
          {{0.088F, -0.125F}, {0.074F, -0.065F}, {0.046F, -0.022F}, {0.024F, 0.006F}, {0, 0.010F}}},
      40);
  builder.use(palette.porcelain);
  add_revolved(builder,
               std::array<Vec2f, 5>{{{0, -0.002F},
                                     {0.020F, -0.004F},
                                     {0.042F, -0.028F},
                                     {0.070F, -0.068F},
                                     {0.084F, -0.125F}}},
               40);
  builder.use(palette.metal);
  add_revolved(builder, std::array<Vec2f, 2>{{{0.084F, -0.125F}, {0.088F, -0.125F}}}, 40);
  add_bulb(builder, "desk lamp", glow, {0, -0.068F, 0}, 0.033F);
  builder.place({});
}

/// Let 4 cm into the ceiling: four reveals and the glowing sheet.
void add_ceiling_panel(SceneBuilder& builder, const RoomPalette& palette) {
  constexpr float kRecess = 0.04F;
  const auto [x0, z0, x1, z1] = kCeilingPanelArea;
  const float y0 = kRoomHeight, y1 = kRoomHeight + kRecess;
  builder.begin_object("ceiling panel recess");
  builder.use(palette.paint);
  builder.quad({x0, y0, z0}, {x1, y0, z0}, {x1, y1, z0}, {x0, y1, z0});
  builder.quad({x1, y0, z1}, {x0, y0, z1}, {x0, y1, z1}, {x1, y1, z1});
  builder.quad({x0, y0, z1}, {x0, y0, z0}, {x0, y1, z0}, {x0, y1, z1});
  builder.quad({x1, y0, z0}, {x1, y0, z1}, {x1, y1, z1}, {x1, y1, z0});
  builder.begin_object("ceiling panel");
  builder.use(builder.add_glowing("ceiling panel", {24, 23, 21}));
  builder.quad({x0, y1, z0}, {x1, y1, z0}, {x1, y1, z1}, {x0, y1, z1});
}

}  // namespace

void add_room_lamps(SceneBuilder& builder, const RoomPalette& palette) {
  const auto glow = builder.add_glowing("warm bulb", kWarm);
  Material cloth;
  cloth.name = "lamp cloth";
  cloth.reflectance = {0.74F, 0.68F, 0.56F};
  cloth.two_sided = true;
  const auto shade = builder.add_material(cloth);
  add_pendant(builder, palette, glow);
  add_floor_lamp(builder, palette, glow, shade);
  add_desk_lamp(builder, palette, glow);
  add_ceiling_panel(builder, palette);
}

}  // namespace relumbre
