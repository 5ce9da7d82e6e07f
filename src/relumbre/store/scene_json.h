/// The parts of a scene that are not arrays, as JSON: what a store keeps in scene/description.
///
///   {"materials": [{"name", "reflectance", "emission", "two_sided", "texture" (index, if any)}],
///    "objects":   [{"name"}],
///    "textures":  [{"name"}],
///    "lights":    [{"name", "type": "point" | "spot" | "directional" | "quad" | "emitter",
///                   "position", "direction", "edge1", "edge2", "inner_deg", "outer_deg",
///                   "rotation_deg", "color", "intensity", "on", "object" (emitters)}],
///    "cameras":   [{"name", "eye", "target", "up", "vfov_deg"}]}
#pragma once

#include <string>
#include <string_view>

#include "relumbre/scene/scene.h"

namespace relumbre {

/// Names that are not UTF-8 lose the offending bytes. Throws ValueError for a light that refers to
/// a file (IES, sky): those belong to lights.json, not to a scene.
std::string scene_to_json(const Scene& scene);

/// Fills materials, objects, textures (names only), lights and cameras. Throws FileError naming the
/// entry and the key.
void scene_from_json(std::string_view text, const std::string& file_name, Scene& scene);

}  // namespace relumbre
