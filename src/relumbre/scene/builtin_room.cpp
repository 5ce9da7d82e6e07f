#include "relumbre/scene/builtin_room.h"

#include "relumbre/scene/builtin_scenes.h"

namespace relumbre {

RoomPalette add_room_palette(SceneBuilder& builder) {
  RoomPalette palette{};
  palette.white_wall = builder.add_matt("white wall", {0.76F, 0.74F, 0.69F});
  palette.terracotta = builder.add_matt("terracotta", {0.60F, 0.23F, 0.13F});
  palette.ceiling = builder.add_matt("ceiling white", {0.84F, 0.84F, 0.82F});
  palette.oak_floor = builder.add_matt("oak floor", {0.47F, 0.32F, 0.19F});
  palette.paint = builder.add_matt("white paint", {0.80F, 0.80F, 0.78F});
  palette.oak = builder.add_matt("oak", {0.56F, 0.39F, 0.22F});
  palette.walnut = builder.add_matt("walnut", {0.25F, 0.14F, 0.08F});
  palette.metal = builder.add_matt("dark metal", {0.10F, 0.10F, 0.11F});
  palette.porcelain = builder.add_matt("porcelain", {0.82F, 0.82F, 0.80F});
  return palette;
}

Scene make_room_scene() {
  SceneBuilder builder;
  const RoomPalette palette = add_room_palette(builder);
  add_room_shell(builder, palette);
  add_room_furniture(builder, palette);
  add_room_things(builder, palette);
  add_room_decor(builder, palette);
  add_room_lamps(builder, palette);
  builder.add_camera({"main", {0.35F, 1.55F, 3.80F}, {2.95F, 0.92F, 1.0F}, {0, 1, 0}, 60});
  builder.add_camera({"corner", {4.85F, 2.05F, 3.85F}, {1.90F, 0.75F, 1.0F}, {0, 1, 0}, 58});
  return std::move(builder).finish();
}

}  // namespace relumbre
