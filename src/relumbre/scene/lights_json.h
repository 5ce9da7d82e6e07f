/// lights.json: the lights a user adds to a scene, and what is done to the scene's own.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relumbre/scene/light.h"
#include "relumbre/scene/scene.h"

namespace relumbre {

/// An array of objects, or {"lights": array}. Keys of every light: "name" (default "light
/// <index>"), "type", "color" (default [1,1,1]), "intensity" (default 1), "on" (default true).
/// Angles are in degrees, lengths in metres. Keys by type, (*) if required:
///
/// - point: position*
/// - spot: position*, direction*, outer_deg*, inner_deg; half-angles, 0 ≤ inner ≤ outer ≤ 90
/// - directional: direction*
/// - quad: corner*, edge1*, edge2*
/// - ies: file* (LM-63), position*, direction*, rotation_deg
/// - sky: file (EXR; without it the CIE overcast sky), rotation_deg
/// - scene: name* of a light of the scene
///
/// Files are looked up relative to the JSON file.
///
/// A light of type "scene" comes back as the scene's light of that name with its color and
/// intensity multiplied and `on` set; it is how emissive objects are dimmed, coloured and switched.
/// Names are unique. Throws FileError naming the light and the key: unknown, missing, of another
/// type, negative, not finite; an unknown light type; a name taken twice or by a light of the
/// scene.
std::vector<Light> read_lights(const std::filesystem::path& file, const Scene& scene);

/// The same of text; `folder` is where "file" keys start from.
std::vector<Light> parse_lights(std::string_view text, const std::string& file_name,
                                const std::filesystem::path& folder, const Scene& scene);

/// What shines: the scene's lights (only those that `read` adjusts unless `use_scene_lights`), in
/// their order and adjusted, then the other lights of `read`. Lights are matched by name.
std::vector<Light> combine_lights(std::span<const Light> scene_lights, std::span<const Light> read,
                                  bool use_scene_lights);

}  // namespace relumbre
