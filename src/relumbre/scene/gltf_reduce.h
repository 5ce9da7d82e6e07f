/// A glTF document cut down to what the mesh importer has to see, every value of it checked.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "relumbre/scene/gltf_document.h"
#include "relumbre/scene/gltf_material.h"

namespace relumbre {

struct ReducedGltf {
  nlohmann::json json;
  std::vector<GltfMaterial> materials;  ///< a material named "3" in `json` is materials[3]
  std::size_t points_and_lines = 0;     ///< vertices of the primitives that were no triangles
  std::vector<std::string> warnings;
};

/// Rebuilds the document from the parts that describe triangles and materials: the scene's node
/// tree, positions, normals, texture coordinates, indices, base colour, emission, textures. Lights,
/// cameras, animations, skins and morph targets are left out. So that what follows can trust it:
///
///   - every index points to something that exists, every accessor lies inside its buffer, every
///     buffer inside its file, and nodes form trees at most 128 deep;
///   - buffer files are named relative to `folder` and do not leave it.
///
/// Changed on the way, because Assimp 5.2 does not know the extensions:
///   - emissiveFactor is multiplied by KHR_materials_emissive_strength;
///   - KHR_materials_pbrSpecularGlossiness' diffuse colour and texture become the base colour;
///   - primitives without a material get one of `default_reflectance`;
///   - nodes that have a mesh but no name are named after the mesh;
///   - materials are named by their index, so that they can be told apart afterwards, and
///     KHR_texture_transform moves to ReducedGltf::materials (Assimp gets it wrong).
///
/// Throws FileError naming the object and the key. A required extension that is not known is
/// refused by name.
ReducedGltf reduce_gltf(const GltfDocument& document, const std::filesystem::path& folder,
                        const std::string& file_name, float default_reflectance);

}  // namespace relumbre
