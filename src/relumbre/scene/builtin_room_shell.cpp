#include <string>
#include <utility>

#include "relumbre/scene/builtin_room.h"

namespace relumbre {

namespace {

constexpr float kSkirtingHeight = 0.09F, kSkirtingDepth = 0.014F;
constexpr float kReveal = 0.20F;  ///< how deep the windows sit in the wall

// The inner faces, each seen from inside with its front towards the room: (u, v) → world.
constexpr Plane kFloor{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};              // (z, x)
constexpr Plane kCeiling{{0, kRoomHeight, 0}, {1, 0, 0}, {0, 0, 1}};  // (x, z)
constexpr Plane kNorth{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};              // (x, y)
constexpr Plane kSouth{{0, 0, kRoomDepth}, {0, 1, 0}, {1, 0, 0}};     // (y, x)
constexpr Plane kWest{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};               // (y, z)
constexpr Plane kEast{{kRoomWidth, 0, 0}, {0, 0, 1}, {0, 1, 0}};      // (z, y)

Rect swapped(const Rect& r) { return {r.v0, r.u0, r.v1, r.u1}; }
Rect inset(const Rect& r, float by) { return {r.u0 + by, r.v0 + by, r.u1 - by, r.v1 - by}; }

/// The floor ends at the skirting and has a hole under the rug: what nobody can see is not there,
/// so no element of the floor is half lit and half buried.
void add_floor(SceneBuilder& builder, const RoomPalette& palette) {
  const Rect whole{0, 0, kRoomDepth, kRoomWidth};
  builder.begin_object("floor");
  builder.use(palette.oak_floor);
  add_panel(builder, kFloor, inset(whole, kSkirtingDepth), std::array{swapped(kRugArea)});
  builder.begin_object("skirting");
  builder.use(palette.paint);
  add_frame(builder, kFloor,
            {whole, inset(whole, kSkirtingDepth), 0, kSkirtingHeight, false, false});
}

/// Walls stand on the skirting and have holes behind the pictures and the door.
void add_walls(SceneBuilder& builder, const RoomPalette& palette) {
  const auto wall = [&](const char* name, std::uint32_t material, const Plane& plane,
                        const Rect& rect, std::span<const Rect> holes) {
    builder.begin_object(name);
    builder.use(material);
    add_panel(builder, plane, rect, holes);
  };
  const float low = kSkirtingHeight;
  wall("north wall", palette.terracotta, kNorth, {0, low, kRoomWidth, kRoomHeight}, kNorthPictures);
  wall("south wall", palette.white_wall, kSouth, {low, 0, kRoomHeight, kRoomWidth}, {});
  wall("west wall", palette.white_wall, kWest, {low, 0, kRoomHeight, kRoomDepth},
       std::array{kWestPicture, Rect{low, kDoor.v0, kDoor.u1, kDoor.v1}});
  wall("east wall", palette.white_wall, kEast, {0, low, kRoomDepth, kRoomHeight}, kWindows);
  wall("ceiling", palette.ceiling, kCeiling, {0, 0, kRoomWidth, kRoomDepth},
       std::array{kCeilingPanelArea});
}

/// Casement bars: a mullion from top to bottom and a transom on either side of it.
void add_window_bars(SceneBuilder& builder, const Rect& glass, float x0, float x1) {
  constexpr float kHalf = 0.022F;
  const float middle = (glass.u0 + glass.u1) / 2, bar = glass.v0 + 0.70F * (glass.v1 - glass.v0);
  add_box(builder, {x0, glass.v0, middle - kHalf}, {x1, glass.v1, middle + kHalf},
          kAllFaces & ~(kBottomFace | kTopFace));
  for (const auto& [z0, z1] : {std::pair{glass.u0, middle - kHalf}, {middle + kHalf, glass.u1}})
    add_box(builder, {x0, bar - kHalf, z0}, {x1, bar + kHalf, z1},
            kAllFaces & ~(kBackFace | kFrontFace));
}

/// The opening's reveals, a frame with bars half way through them, and the board on the sill.
void add_window(SceneBuilder& builder, const RoomPalette& palette, const Rect& opening,
                const std::string& name) {
  constexpr float kFrameFront = 0.11F, kFrameDepth = 0.05F, kFrameWidth = 0.055F;
  builder.begin_object(name + " reveal");
  builder.use(palette.paint);
  // Outward past the wall: a frame whose inner sides are all that is there.
  const auto [z0, y0, z1, y1] = opening;
  const float x0 = kRoomWidth, x1 = kRoomWidth + kReveal;
  builder.quad({x0, y0, z0}, {x0, y0, z1}, {x1, y0, z1}, {x1, y0, z0});
  builder.quad({x0, y1, z0}, {x1, y1, z0}, {x1, y1, z1}, {x0, y1, z1});
  builder.quad({x0, y0, z0}, {x1, y0, z0}, {x1, y1, z0}, {x0, y1, z0});
  builder.quad({x0, y0, z1}, {x0, y1, z1}, {x1, y1, z1}, {x1, y0, z1});
  builder.begin_object(name + " frame");
  const Plane outside{{kRoomWidth + kFrameFront + kFrameDepth, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  const Rect glass = inset(opening, kFrameWidth);
  add_frame(builder, outside, {opening, glass, 0, kFrameDepth, false, true});
  add_window_bars(builder, glass, kRoomWidth + kFrameFront + 0.01F,
                  kRoomWidth + kFrameFront + kFrameDepth - 0.01F);
  builder.begin_object(name + " board");
  add_box(builder, {kRoomWidth - 0.09F, y0 - 0.03F, z0 - 0.06F}, {kRoomWidth, y0, z1 + 0.06F},
          kAllFaces & ~kRightFace);
}

/// A casing, a leaf behind it with four raised panels, and a handle, all on the west wall.
void add_door(SceneBuilder& builder, const RoomPalette& palette) {
  constexpr float kCasing = 0.08F;
  constexpr float kNear = kDoor.v0 + kCasing, kFar = kDoor.v1 - kCasing, kTop = kDoor.u1 - kCasing;
  constexpr float kLeafHeight = 0.022F, kPanelHeight = 0.030F;
  builder.begin_object("door");
  builder.use(builder.add_matt("door paint", {0.36F, 0.44F, 0.43F}));
  for (const auto& [z0, z1] : {std::pair{kNear - kCasing, kNear}, {kFar, kFar + kCasing}})
    add_box(builder, {0, 0, z0}, {0.038F, kTop, z1}, kRightFace | kBackFace | kFrontFace);
  add_box(builder, {0, kTop, kNear - kCasing}, {0.038F, kTop + kCasing, kFar + kCasing},
          kAllFaces & ~kLeftFace);
  const std::array<Rect, 4> panels{{{0.25F, kNear + 0.11F, 0.90F, kNear + 0.375F},
                                    {0.25F, kFar - 0.375F, 0.90F, kFar - 0.11F},
                                    {1.05F, kNear + 0.11F, 1.90F, kNear + 0.375F},
                                    {1.05F, kFar - 0.375F, 1.90F, kFar - 0.11F}}};
  add_panel(builder, kWest, {0, kNear, kTop, kFar}, panels, kLeafHeight);
  for (const Rect& panel : panels) add_slab(builder, kWest, panel, kLeafHeight, kPanelHeight);
  builder.begin_object("door handle");
  builder.use(palette.metal);
  add_bar(builder, {kLeafHeight, 1.0F, kNear + 0.06F}, {0.07F, 1.0F, kNear + 0.06F}, 0.009F, 0.009F,
          16);
  add_bar(builder, {0.08F, 1.0F, kNear + 0.05F}, {0.08F, 1.0F, kNear + 0.18F}, 0.010F, 0.008F, 16);
}

}  // namespace

void add_room_shell(SceneBuilder& builder, const RoomPalette& palette) {
  add_floor(builder, palette);
  add_walls(builder, palette);
  add_window(builder, palette, kWindows[0], "north window");
  add_window(builder, palette, kWindows[1], "south window");
  add_door(builder, palette);
}

}  // namespace relumbre
