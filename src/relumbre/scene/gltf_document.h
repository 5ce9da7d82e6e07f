/// The two containers of glTF 2: JSON text (.gltf) and binary (.glb).
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

namespace relumbre {

/// A .glb is   magic "glTF" | version 2 | total length          12 bytes
///             JSON length  | "JSON"    | JSON, space-padded     8 + length
///             BIN length   | "BIN\0"   | BIN, zero-padded       8 + length, optional
/// with little-endian 32-bit numbers and lengths that are multiples of 4.
struct GltfDocument {
  nlohmann::json json;
  std::string bytes;  ///< the file as it was
  bool binary_container = false;
  std::size_t bin_begin = 0, bin_size = 0;  ///< the BIN chunk within `bytes`
};

/// Takes either container, told apart by the magic number. Throws FileError: not glTF, not version
/// 2, truncated, JSON that does not parse. Structure below the top level is not looked at.
GltfDocument parse_gltf(std::string bytes, const std::string& file_name);

/// The file again, in the same container, with `document.json` as its JSON. O(bytes).
std::string serialize(const GltfDocument& document, const std::string& file_name);

}  // namespace relumbre
