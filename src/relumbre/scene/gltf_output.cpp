#include "relumbre/scene/gltf_output.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/box.h"
#include "relumbre/base/error.h"

namespace relumbre {

namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

constexpr int kFloat = 5126, kUnsignedInt = 5125;
constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963, kNoTarget = 0;

template <class T>
std::string_view bytes_of(std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

void pad_to_4(std::string& bytes, char fill) { bytes.resize((bytes.size() + 3) / 4 * 4, fill); }

void append_word(std::string& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<char>(static_cast<unsigned char>((value >> shift) & 0xFF)));
}

/// RFC 4648, §4.
std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (j < have ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      text.push_back(j <= have ? kDigits[group >> (18 - 6 * j) & 63U] : '=');
  }
  return text;
}

std::string glb(std::string text, const std::string& buffer, const std::string& path) {
  constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBin = 0x004E4942;
  pad_to_4(text, ' ');
  const std::size_t bin = buffer.empty() ? 0 : 8 + buffer.size();
  const std::size_t total = 12 + 8 + text.size() + bin;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw FileError(path, "a .glb holds at most 4 GiB, this scene needs " + std::to_string(total) +
                              " bytes; write .gltf");
  std::string file;
  file.reserve(total);
  for (const std::size_t word :
       {std::size_t{kMagic}, std::size_t{kVersion}, total, text.size(), std::size_t{kJson}})
    append_word(file, word);
  file += text;
  if (buffer.empty()) return file;
  append_word(file, buffer.size());
  append_word(file, kBin);
  return file += buffer;
}

}  // namespace

double short_decimal(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double decimal = 0;
  std::from_chars(text.data(), end, decimal);
  return decimal;
}

Json to_json(const Vec3f& v) {
  return {short_decimal(v.x), short_decimal(v.y), short_decimal(v.z)};
}

GltfOutput::GltfOutput() { json["asset"] = {{"version", "2.0"}, {"generator", "Relumbre"}}; }

std::size_t GltfOutput::append(const std::string& list, Json entry) {
  json[list].push_back(std::move(entry));
  return json[list].size() - 1;
}

void GltfOutput::use_extension(const std::string& name) {
  Json& used = json["extensionsUsed"];
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

std::size_t GltfOutput::add_view(std::string_view bytes) {
  pad_to_4(buffer_, '\0');
  const std::size_t offset = buffer_.size();
  buffer_ += bytes;
  return append("bufferViews",
                {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
}

std::size_t GltfOutput::add_accessor(std::string_view bytes, std::size_t count, int component,
                                     const char* type, int target) {
  const std::size_t view = add_view(bytes);
  if (target != kNoTarget) json["bufferViews"][view]["target"] = target;
  return append(
      "accessors",
      {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
}

std::size_t GltfOutput::add_positions(std::span<const Vec3f> positions) {
  const std::size_t accessor = add_vectors(positions);
  const Box box = bounds(positions);
  json["accessors"][accessor]["min"] = to_json(box.lower);
  json["accessors"][accessor]["max"] = to_json(box.upper);
  return accessor;
}

std::size_t GltfOutput::add_vectors(std::span<const Vec3f> vectors) {
  static_assert(sizeof(Vec3f) == 12);
  return add_accessor(bytes_of(vectors), vectors.size(), kFloat, "VEC3", kVertexBuffer);
}

std::size_t GltfOutput::add_texcoords(std::span<const Vec2f> texcoords) {
  static_assert(sizeof(Vec2f) == 8);
  return add_accessor(bytes_of(texcoords), texcoords.size(), kFloat, "VEC2", kVertexBuffer);
}

std::size_t GltfOutput::add_indices(std::span<const std::uint32_t> indices) {
  return add_accessor(bytes_of(indices), indices.size(), kUnsignedInt, "SCALAR", kIndexBuffer);
}

void GltfOutput::write(const std::filesystem::path& path) const {
  const bool binary = path.extension() == ".glb";
  if (!binary && path.extension() != ".gltf")
    throw ValueError(path.string() + ": the name of a glTF file ends in .glb or .gltf");
  std::string buffer = buffer_;
  pad_to_4(buffer, '\0');
  Json document = json;
  if (!buffer.empty()) {
    Json entry{{"byteLength", buffer.size()}};
    if (!binary) entry["uri"] = "data:application/octet-stream;base64," + base64(buffer);
    document["buffers"] = Json::array({entry});
  }
  const auto replace = Json::error_handler_t::replace;  // names that are not UTF-8
  write_file(path, binary ? glb(document.dump(-1, ' ', false, replace), buffer, path.string())
                          : document.dump(1, ' ', false, replace) + "\n");
}

}  // namespace relumbre
