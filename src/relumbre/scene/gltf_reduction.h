/// What the parts of the glTF reduction share. Internal to the import.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "relumbre/scene/gltf_document.h"
#include "relumbre/scene/gltf_material.h"
#include "relumbre/scene/json_fields.h"

namespace relumbre {

/// The document that is read, and the reduced one that is built section by section; each section is
/// checked against those before it.
struct GltfReduction {
  const GltfDocument& document;
  std::filesystem::path folder;
  std::string file_name;
  nlohmann::json out;
  std::vector<GltfMaterial> materials;  ///< one for every entry of the section
  std::vector<std::string> warnings;

  /// How many objects a finished section has.
  [[nodiscard]] std::size_t count(const char* key) const { return out.at(key).size(); }
  /// Adds a warning unless it is there already.
  void warn(const std::string& warning);
  /// out[key] = the rule's answer for every object of the document's array of that name.
  void section(const char* key, const std::string& singular,
               const std::function<nlohmann::json(const JsonFields&, std::size_t)>& rule);
};

/// The object's name, cut to what Assimp's strings hold, or the fallback.
std::string gltf_name(const JsonFields& fields, const std::string& fallback);

/// Sections buffers, bufferViews and accessors.
void reduce_gltf_buffers(GltfReduction& reduction);

/// Sections images, textures and materials; needs the buffers.
void reduce_gltf_materials(GltfReduction& reduction);

}  // namespace relumbre
