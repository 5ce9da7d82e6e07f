/// Scenes that come with the library. Metres, y up, linear RGB, one-sided unless a sheet is thin.
#pragma once

#include <span>
#include <string_view>

#include "relumbre/scene/scene.h"

namespace relumbre {

struct BuiltinScene {
  std::string_view name;
  std::string_view description;  ///< one line
};

std::span<const BuiltinScene> builtin_scenes();

/// Throws ValueError that lists the known names.
Scene make_builtin_scene(std::string_view name);

/// The Cornell box: 36 triangles, measured geometry and reflectances, front open.
Scene make_cornell_scene();
/// A furnished 5 × 4 × 2.7 m room with two windows, a door and four lamps.
Scene make_room_scene();
/// A closed unit cube that faces inward: reflectance ½ and exitance 1 everywhere, so that
/// radiosity is 2 everywhere. 12 triangles.
Scene make_furnace_cube_scene();
/// Five Utah teapots in a receding row under a soft box.
Scene make_teapots_scene();

}  // namespace relumbre
