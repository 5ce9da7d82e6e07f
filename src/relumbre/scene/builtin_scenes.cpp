#include "relumbre/scene/builtin_scenes.h"

#include <array>
#include <string>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

struct Entry {
  BuiltinScene scene;
  Scene (*make)();
};

constexpr std::array kEntries{
    Entry{{"cornell", "the Cornell box: 36 triangles, measured geometry and reflectances"},
          make_cornell_scene},
    Entry{{"room", "a furnished room with two windows, a door and four lamps"}, make_room_scene},
    Entry{{"furnace-cube", "a closed cube, reflectance 1/2, exitance 1: radiosity is 2 everywhere"},
          make_furnace_cube_scene},
    Entry{{"teapots", "five Utah teapots in a receding row, for depth of field"},
          make_teapots_scene},
};

constexpr auto kList = [] {
  std::array<BuiltinScene, kEntries.size()> list{};
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = kEntries[i].scene;
  return list;
}();

}  // namespace

std::span<const BuiltinScene> builtin_scenes() { return kList; }

Scene make_builtin_scene(std::string_view name) {
  std::string known;
  for (const auto& [scene, make] : kEntries) {
    if (scene.name == name) return make();
    known += (known.empty() ? "" : ", ") + std::string(scene.name);
  }
  throw ValueError("no built-in scene '" + std::string(name) + "'; there are " + known);
}

}  // namespace relumbre
