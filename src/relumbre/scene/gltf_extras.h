/// Lights and cameras of a glTF scene.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "relumbre/scene/camera.h"
#include "relumbre/scene/light.h"

namespace relumbre {

struct GltfExtrasConfig {
  float scale = 1;                  ///< metres a unit
  bool photometric_lights = false;  ///< intensities are candela and lux: divide by 683 lm/W
};

struct GltfExtras {
  std::vector<Light> lights;    ///< KHR_lights_punctual, one for every node that has one
  std::vector<Camera> cameras;  ///< perspective cameras, one for every node that has one
  std::vector<std::string> warnings;
};

/// Walks the nodes of the document's scene and places its lights and cameras in world space. Assimp
/// 5.2 is not asked because it gives every light one node only and finds nodes by names that need
/// not be unique. Point and spot intensities are read as W/sr, directional ones as W/m², unless
/// photometric. `json` must have passed reduce_gltf (nodes form trees). Throws FileError.
GltfExtras read_gltf_extras(const nlohmann::json& json, const std::string& file_name,
                            const GltfExtrasConfig& config);

}  // namespace relumbre
