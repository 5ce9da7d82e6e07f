/// Assimp's node tree and meshes as one world-space mesh. Internal to the import.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "relumbre/scene/gltf_material.h"
#include "relumbre/scene/import.h"
#include "relumbre/scene/import_files.h"

struct aiScene;

namespace relumbre {

/// Fills result.scene's mesh, texture coordinates, shading normals, objects, materials and
/// textures. Meshes of the source are freed as soon as no node needs them any more. Throws
/// FileError for indices out of range and for more than 2^30 triangles or 2^31 vertices.
void import_meshes(std::unique_ptr<aiScene> source, SceneKind kind,
                   const std::filesystem::path& file, const ImportConfig& config,
                   std::span<const GltfMaterial> gltf_materials, ImportResult& result);

}  // namespace relumbre
