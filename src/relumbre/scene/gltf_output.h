/// A glTF 2.0 file in the making: JSON and one binary buffer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// Shortest decimal that reads back as the same float: 0.1F becomes 0.1, not 0.10000000149.
double short_decimal(float value);
nlohmann::json to_json(const Vec3f& v);

/// Collects accessors over one buffer and writes the document as .glb (one file) or .gltf (the
/// buffer embedded as base64). `json` is open to whatever else the document holds; asset, buffers,
/// bufferViews and accessors are kept here.
///
///   .glb   header 12 | JSON chunk, padded with spaces to 4 | BIN chunk, padded with zeros to 4
///
/// Source: Khronos, glTF 2.0 Specification, §3.6 (accessors) and §4.4 (GLB).
class GltfOutput {
 public:
  GltfOutput();

  nlohmann::json json;

  /// Each returns the accessor's index. Positions get the min and max that the format asks for.
  std::size_t add_positions(std::span<const Vec3f> positions);
  std::size_t add_vectors(std::span<const Vec3f> vectors);
  std::size_t add_texcoords(std::span<const Vec2f> texcoords);
  std::size_t add_indices(std::span<const std::uint32_t> indices);
  /// The index of a buffer view over a copy of `bytes`.
  std::size_t add_view(std::string_view bytes);

  /// Appends to the top-level array `list` and returns the new entry's index.
  std::size_t append(const std::string& list, nlohmann::json entry);
  void use_extension(const std::string& name);

  /// Writes atomically, by the path's extension. Throws ValueError for one that is neither .glb nor
  /// .gltf, FileError if the file cannot be written or a .glb would pass 4 GiB.
  void write(const std::filesystem::path& path) const;

 private:
  std::size_t add_accessor(std::string_view bytes, std::size_t count, int component,
                           const char* type, int target);

  std::string buffer_;
};

}  // namespace relumbre
