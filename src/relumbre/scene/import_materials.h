/// Assimp's materials and textures as Relumbre's. Internal to the import.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "relumbre/scene/gltf_material.h"
#include "relumbre/scene/import.h"
#include "relumbre/scene/import_files.h"

struct aiMaterial;
struct aiScene;

namespace relumbre {

/// `gltf` holds notes on materials that are named by their index into it; empty for other formats.
/// Converts a material when it is first used, so that those that nothing uses neither appear nor
/// warn. Appends to scene.materials, scene.textures and report.warnings.
class MaterialImporter {
 public:
  MaterialImporter(const aiScene& source, SceneKind kind, std::filesystem::path file,
                   const ImportConfig& config, std::span<const GltfMaterial> gltf, Scene& scene,
                   ImportReport& report);

  /// Index into scene.materials of the source's material. Where the file gives it no colour, it is
  /// white below vertex colours and config.default_reflectance without them.
  std::uint32_t use(unsigned source_index, bool has_vertex_colors);
  /// Which set of texture coordinates the base colour texture of that material reads.
  [[nodiscard]] unsigned texcoord_set(unsigned source_index) const;
  /// What turns those coordinates (v downwards) into the texture's.
  [[nodiscard]] TexcoordMap texcoord_map(unsigned source_index) const;

 private:
  [[nodiscard]] const GltfMaterial* notes_on(const aiMaterial& source) const;
  [[nodiscard]] std::string name_of(const aiMaterial& source) const;
  Material convert(const aiMaterial& source, bool has_vertex_colors);
  [[nodiscard]] bool has_own_colour(const aiMaterial& source) const;
  void set_reflectance(const aiMaterial& source, Material& material);
  void set_emission(const aiMaterial& source, Material& material);
  void set_sides(const aiMaterial& source, Material& material) const;
  void warn_if_transparent(const aiMaterial& source, const Material& material);
  std::uint32_t base_texture(const aiMaterial& source, const Material& material);
  /// Index into scene.textures, or kNone (with a warning) if it cannot be read.
  std::uint32_t load_texture(const std::string& path, const Material& material);
  [[nodiscard]] Texture decode_texture(const std::string& path) const;
  [[nodiscard]] std::filesystem::path find_texture(const std::string& path) const;

  const aiScene& source_;
  SceneKind kind_;
  std::filesystem::path file_;
  const ImportConfig& config_;
  std::span<const GltfMaterial> gltf_;
  Scene& scene_;
  ImportReport& report_;
  std::vector<std::uint32_t> used_;  ///< by source index; kNone while unused
  std::map<std::string, std::uint32_t> textures_;
};

}  // namespace relumbre
