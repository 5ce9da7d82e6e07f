/// The parts of the built-in room; each adds its objects to the builder.
///
///        north (z = 0)   sofa, shelf          x to the east, y up, z to the south
///      ┌──────────────────────┐
/// west │ side table  sofa  shelf │ east: two windows
/// door │  rug, low table   dining │
///      └──────────────────────┘
///        south (z = 4)   camera "main" looks north-east
#pragma once

#include <array>

#include "relumbre/scene/shapes.h"

namespace relumbre {

/// Inner dimensions, metres.
inline constexpr float kRoomWidth = 5.0F, kRoomHeight = 2.7F, kRoomDepth = 4.0F;

/// Where things stand that more than one part must know.
inline constexpr Rect kRugArea{0.75F, 1.15F, 2.95F, 2.65F};           ///< (x, z)
inline constexpr Rect kCeilingPanelArea{1.25F, 1.45F, 2.45F, 2.05F};  ///< (x, z)
inline constexpr Vec3f kDiningCenter{3.86F, 0, 2.28F};
inline constexpr float kDiningHeight = 0.75F;
inline constexpr float kLowTableHeight = 0.40F;
inline constexpr Vec3f kSideTable{0.40F, 0, 0.46F};
inline constexpr float kSideTableHeight = 0.52F;
/// The shelf's outline in (x, z); the heights of its boards' upper sides, evenly spaced.
inline constexpr Rect kShelf{3.48F, 0.025F, 4.42F, 0.305F};
inline constexpr float kShelfBoard = 0.022F, kShelfPitch = 0.36F;
inline constexpr std::array<float, 5> kShelfLevels{0.10F, 0.46F, 0.82F, 1.18F, 1.54F};
inline constexpr Vec3f kPlant{4.70F, 0, 0.34F};
/// Pictures: on the north wall in (x, y), on the west wall in (y, z).
inline constexpr std::array<Rect, 3> kNorthPictures{
    {{0.98F, 1.22F, 1.46F, 1.84F}, {1.60F, 1.22F, 2.20F, 1.84F}, {2.34F, 1.22F, 2.82F, 1.84F}}};
inline constexpr Rect kWestPicture{1.20F, 1.05F, 1.85F, 1.95F};
/// The door with its casing, on the west wall in (y, z).
inline constexpr Rect kDoor{0, 2.47F, 2.11F, 3.48F};
/// Openings of the east wall in (z, y).
inline constexpr std::array<Rect, 2> kWindows{
    {{0.60F, 0.85F, 1.75F, 2.30F}, {2.30F, 0.85F, 3.45F, 2.30F}}};

/// Materials that several parts share.
struct RoomPalette {
  std::uint32_t white_wall, terracotta, ceiling, oak_floor, paint, oak, walnut, metal, porcelain;
};
RoomPalette add_room_palette(SceneBuilder& builder);

/// Floor, walls, ceiling, skirting, windows and door.
void add_room_shell(SceneBuilder& builder, const RoomPalette& palette);
/// Sofa, tables, chairs, shelf and rug.
void add_room_furniture(SceneBuilder& builder, const RoomPalette& palette);
/// Books, vases and crockery.
void add_room_things(SceneBuilder& builder, const RoomPalette& palette);
/// Pictures and a plant.
void add_room_decor(SceneBuilder& builder, const RoomPalette& palette);
/// Four lamps; the part of each that glows is an object of its own.
void add_room_lamps(SceneBuilder& builder, const RoomPalette& palette);

}  // namespace relumbre
