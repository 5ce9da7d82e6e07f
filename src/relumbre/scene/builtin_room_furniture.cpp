#include <array>
#include <string>

#include "relumbre/scene/builtin_room.h"

namespace relumbre {

namespace {

constexpr float kRugHeight = 0.012F;

void add_rug(SceneBuilder& builder) {
  // The rug's outline in (z, x), as the floor's.
  const Plane ground{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  const Rect outer{kRugArea.v0, kRugArea.u0, kRugArea.v1, kRugArea.u1};
  const auto inset = [&](float by) {
    return Rect{outer.u0 + by, outer.v0 + by, outer.u1 - by, outer.v1 - by};
  };
  builder.begin_object("rug");
  builder.use(builder.add_matt("rug border", {0.16F, 0.20F, 0.30F}));
  add_frame(builder, ground, {outer, inset(0.10F), 0, kRugHeight, true, false});
  builder.use(builder.add_matt("rug field", {0.66F, 0.59F, 0.47F}));
  add_panel(builder, ground, inset(0.10F), std::array{inset(0.17F)}, kRugHeight);
  add_panel(builder, ground, inset(0.20F), {}, kRugHeight);
  builder.use(builder.add_matt("rug line", {0.55F, 0.20F, 0.12F}));
  add_panel(builder, ground, inset(0.17F), std::array{inset(0.20F)}, kRugHeight);
}

/// 2.2 m wide, its back to the north wall.
void add_sofa(SceneBuilder& builder, const RoomPalette& palette) {
  constexpr float x0 = 0.80F, x1 = 3.00F, z0 = 0.07F, z1 = 0.97F, kArm = 0.18F, kGap = 0.006F;
  builder.begin_object("sofa");
  builder.use(builder.add_matt("teal cloth", {0.05F, 0.29F, 0.31F}));
  add_rounded_box(builder, {x0, 0.12F, z0}, {x1, 0.30F, z1 - 0.02F}, 0.03F);
  for (const float x : {x0, x1 - kArm})
    add_rounded_box(builder, {x, 0.30F + kGap, z0}, {x + kArm, 0.62F, z1 - 0.03F}, 0.06F);
  add_rounded_box(builder, {x0 + kArm + kGap, 0.30F + kGap, z0},
                  {x1 - kArm - kGap, 0.80F, z0 + 0.20F}, 0.06F);
  const float seat = (x1 - x0 - 2 * kArm - 3 * kGap) / 2;
  for (int i = 0; i < 2; ++i) {
    const float left = x0 + kArm + kGap + static_cast<float>(i) * (seat + kGap);
    const float right = left + seat;
    add_rounded_box(builder, {left, 0.30F + kGap, z0 + 0.20F + kGap}, {right, 0.45F, z1}, 0.05F);
    // The back cushions lean against the back.
    const ScopedPlacement leaning(builder, {{0, 0.45F + kGap, z0 + 0.29F},
                                            {1, 0, 0},
                                            normalized(Vec3f(0, 1, -0.16F)),
                                            normalized(Vec3f(0, 0.16F, 1))});
    add_rounded_box(builder, {left + 0.01F, 0.02F, 0}, {right - 0.01F, 0.43F, 0.16F}, 0.07F);
  }
  builder.use(palette.walnut);
  for (const float x : {x0 + 0.10F, x1 - 0.10F})
    for (const float z : {z0 + 0.10F, z1 - 0.12F})
      add_leg(builder, {x, 0, z}, {x, 0.12F, z}, 0.016F, 0.026F);
}

void add_pillow(SceneBuilder& builder, const std::string& name, Rgb color, const Vec3f& foot,
                float yaw_deg) {
  builder.begin_object(name);
  builder.use(builder.add_matt(name, color));
  const Placement leaning{
      {}, {1, 0, 0}, normalized(Vec3f(0, 1, -0.38F)), normalized(Vec3f(0, 0.38F, 1))};
  const ScopedPlacement placed(builder, turned(foot, yaw_deg) * leaning);
  add_rounded_box(builder, {-0.20F, 0, -0.055F}, {0.20F, 0.38F, 0.055F}, 0.055F, 3);
}

/// A table with four square legs and an apron, centred on the origin of the placement.
struct TableShape {
  float half_x, half_z, height, top = 0.032F, leg = 0.055F, apron = 0.08F;
};
void add_table(SceneBuilder& builder, const TableShape& t) {
  add_rounded_box(builder, {-t.half_x, t.height - t.top, -t.half_z}, {t.half_x, t.height, t.half_z},
                  0.010F);
  const float under = t.height - t.top, in = 0.045F;
  const float lx = t.half_x - in, lz = t.half_z - in;
  constexpr unsigned kSides = kLeftFace | kRightFace | kBackFace | kFrontFace;
  for (const float sx : {-1.0F, 1.0F})
    for (const float sz : {-1.0F, 1.0F}) {
      const Vec3f a{sx * lx, 0, sz * lz}, b{sx * (lx - t.leg), under, sz * (lz - t.leg)};
      add_box(builder, min(a, b), max(a, b), kSides);
    }
  const float ax = lx - t.leg, az = lz - t.leg, thick = 0.02F, low = under - t.apron;
  for (const float s : {-1.0F, 1.0F}) {
    const float z = s * (lz - t.leg / 2), x = s * (lx - t.leg / 2);
    add_box(builder, {-ax, low, z - thick / 2}, {ax, under, z + thick / 2},
            kBackFace | kFrontFace | kBottomFace);
    add_box(builder, {x - thick / 2, low, -az}, {x + thick / 2, under, az},
            kLeftFace | kRightFace | kBottomFace);
  }
}

void add_tables(SceneBuilder& builder, const RoomPalette& palette) {
  builder.begin_object("dining table");
  builder.use(palette.oak);
  builder.place({kDiningCenter});
  add_table(builder, {0.42F, 0.72F, kDiningHeight});
  builder.begin_object("low table");
  builder.use(palette.walnut);
  builder.place({{1.85F, kRugHeight, 1.80F}});
  add_table(builder, {0.52F, 0.29F, kLowTableHeight - kRugHeight, 0.028F, 0.04F, 0.05F});
  builder.begin_object("side table");
  builder.use(palette.oak);
  builder.place({kSideTable});
  add_revolved(builder,
               std::array<Vec2f, 6>{{{0, kSideTableHeight - 0.025F},
                                     {0.225F, kSideTableHeight - 0.025F},
                                     {0.235F, kSideTableHeight - 0.018F},
                                     {0.235F, kSideTableHeight - 0.006F},
                                     {0.228F, kSideTableHeight},
                                     {0, kSideTableHeight}}},
               48);
  for (const float yaw : {30.0F, 150.0F, 270.0F}) {
    const ScopedPlacement side(builder, turned({}, yaw));
    add_leg(builder, {0.19F, 0, 0}, {0.11F, kSideTableHeight - 0.025F, 0}, 0.011F, 0.018F);
  }
  builder.place({});
}

/// A dining chair that faces +z; the seat is 46 cm high.
void add_chair(SceneBuilder& builder, std::uint32_t frame, std::uint32_t cloth) {
  constexpr float kSeat = 0.425F, kHalf = 0.21F;
  builder.use(frame);
  add_rounded_box(builder, {-kHalf, kSeat, -kHalf}, {kHalf, kSeat + 0.022F, kHalf}, 0.010F, 1);
  for (const float sx : {-1.0F, 1.0F}) {
    add_leg(builder, {sx * 0.20F, 0, 0.205F}, {sx * 0.175F, kSeat, 0.175F}, 0.011F, 0.018F, 12);
    add_leg(builder, {sx * 0.20F, 0, -0.215F}, {sx * 0.175F, kSeat, -0.175F}, 0.011F, 0.018F, 12);
    add_bar(builder, {sx * 0.165F, kSeat + 0.023F, -0.180F}, {sx * 0.165F, 0.84F, -0.248F}, 0.014F,
            0.011F, 12);
  }
  builder.use(cloth);
  add_rounded_box(builder, {-kHalf + 0.01F, kSeat + 0.0225F, -kHalf + 0.075F},
                  {kHalf - 0.01F, kSeat + 0.055F, kHalf - 0.005F}, 0.016F);
  const ScopedPlacement leaning(builder, {{0, 0.60F, -0.190F},
                                          {1, 0, 0},
                                          normalized(Vec3f(0, 1, -0.188F)),
                                          normalized(Vec3f(0, 0.188F, 1))});
  add_rounded_box(builder, {-0.20F, 0.02F, 0}, {0.20F, 0.25F, 0.026F}, 0.012F, 1);
}

void add_chairs(SceneBuilder& builder, const RoomPalette& palette) {
  const auto cloth = builder.add_matt("mustard cloth", {0.62F, 0.40F, 0.07F});
  struct Seat {
    float x, z, yaw_deg;
  };
  constexpr std::array<Seat, 4> kSeats{
      {{-0.60F, -0.33F, 90}, {-0.66F, 0.38F, 112}, {0.55F, -0.34F, -90}, {0.55F, 0.34F, -90}}};
  for (std::size_t i = 0; i < kSeats.size(); ++i) {
    builder.begin_object("chair " + std::to_string(i + 1));
    builder.place(turned(kDiningCenter + Vec3f(kSeats[i].x, 0, kSeats[i].z), kSeats[i].yaw_deg));
    add_chair(builder, palette.oak, cloth);
  }
  builder.place({});
}

/// Two uprights and six boards that end at them, 1 cm off the north wall, with a back panel.
void add_shelf(SceneBuilder& builder, const RoomPalette& palette) {
  constexpr float x0 = kShelf.u0, x1 = kShelf.u1, z0 = kShelf.v0, z1 = kShelf.v1;
  constexpr float kThick = kShelfBoard, kTop = kShelfLevels.back() + kShelfPitch;
  builder.begin_object("shelf");
  builder.use(palette.walnut);
  add_box(builder, {x0, 0, z0}, {x0 + kThick, kTop, z1}, kAllFaces & ~kBottomFace);
  add_box(builder, {x1 - kThick, 0, z0}, {x1, kTop, z1}, kAllFaces & ~kBottomFace);
  constexpr unsigned kBoardFaces = kTopFace | kBottomFace | kFrontFace;
  for (const float level : kShelfLevels)
    add_box(builder, {x0 + kThick, level - kThick, z0 + 0.008F}, {x1 - kThick, level, z1 - 0.005F},
            kBoardFaces);
  add_box(builder, {x0 + kThick, kTop - kThick, z0 + 0.008F}, {x1 - kThick, kTop, z1 - 0.005F},
          kBoardFaces);
  add_box(builder, {x0 + kThick, kShelfLevels.front() - kThick, z0},
          {x1 - kThick, kTop, z0 + 0.008F}, kFrontFace | kBackFace | kTopFace | kBottomFace);
}

}  // namespace

void add_room_furniture(SceneBuilder& builder, const RoomPalette& palette) {
  add_rug(builder);
  add_sofa(builder, palette);
  add_pillow(builder, "mustard pillow", {0.66F, 0.43F, 0.08F}, {1.16F, 0.456F, 0.70F}, 14);
  add_pillow(builder, "cream pillow", {0.72F, 0.66F, 0.55F}, {2.62F, 0.456F, 0.70F}, -16);
  add_tables(builder, palette);
  add_chairs(builder, palette);
  add_shelf(builder, palette);
}

}  // namespace relumbre
