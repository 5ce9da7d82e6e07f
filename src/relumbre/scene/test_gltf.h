/// Small glTF documents for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace relumbre::gltf {

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      out += i + j <= bytes.size() ? digits[bits >> (18 - 6 * j) & 63] : '=';
    }
  }
  return out;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// A unit square in the plane z = 0 that faces +z, of vertices (0,0) (1,0) (1,1) (0,1) with v of
/// the texture downwards. One mesh, one node, no material; the buffer is a data URI of 128 bytes:
///
///   0  indices 6 × u16   |  12  pad  |  16  positions 4 × vec3  |  64  texcoords 4 × vec2  |  96
///   pad
inline nlohmann::json square() {
  std::string bytes = bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3});
  bytes.resize(16);
  bytes += bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  bytes += bytes_of<float>({0, 1, 1, 1, 1, 0, 0, 0});
  bytes.resize(128);
  return {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"name", "square"}}}},
      {"meshes",
       {{{"primitives",
          {{{"attributes", {{"POSITION", 1}, {"TEXCOORD_0", 2}}}, {"indices", 0}}}}}}},
      {"accessors",
       {{{"bufferView", 0}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}},
        {{"bufferView", 1}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
        {{"bufferView", 2}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 12}},
        {{"buffer", 0}, {"byteOffset", 16}, {"byteLength", 48}},
        {{"buffer", 0}, {"byteOffset", 64}, {"byteLength", 32}}}},
      {"buffers",
       {{{"byteLength", 128}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}}},
  };
}

}  // namespace relumbre::gltf
