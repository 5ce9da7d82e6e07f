#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/scene_builder.h"

namespace relumbre {

Scene make_furnace_cube_scene() {
  SceneBuilder builder;
  Material glowing;
  glowing.name = "half";
  glowing.reflectance = Rgb(0.5F);
  glowing.emission = Rgb(1);
  builder.use(builder.add_material(glowing));
  builder.begin_object("cube");
  builder.quad({0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1});
  builder.quad({1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0});
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0});
  builder.quad({0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1});
  builder.quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  builder.quad({0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1});
  builder.add_camera({"main", {0.9F, 0.6F, 0.9F}, {0.2F, 0.4F, 0.1F}, {0, 1, 0}, 60});
  return std::move(builder).finish();
}

}  // namespace relumbre
