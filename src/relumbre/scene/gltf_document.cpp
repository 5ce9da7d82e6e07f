#include "relumbre/scene/gltf_document.h"

#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "relumbre/base/error.h"
#include "relumbre/scene/json_fields.h"

namespace relumbre {
namespace {

constexpr std::string_view kMagic = "glTF";
constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

std::uint32_t read_u32(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint32_t{static_cast<std::uint8_t>(bytes[offset + i])} << (8 * i);
  }
  return value;
}

void append_u32(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xFF));
}

struct Chunk {
  std::size_t begin = 0, size = 0;
};

/// The chunk whose header starts at `offset`; it must be of that type and lie inside the file.
Chunk read_chunk(std::string_view bytes, std::size_t offset, std::uint32_t type,
                 const std::string& file_name) {
  if (bytes.size() < offset + kChunkHeader) throw FileError(file_name, "the .glb is truncated");
  const std::size_t size = read_u32(bytes, offset);
  if (read_u32(bytes, offset + 4) != type) {
    throw FileError(file_name, "the .glb has a chunk of an unexpected type");
  }
  const std::size_t begin = offset + kChunkHeader;
  if (bytes.size() - begin < size) throw FileError(file_name, "the .glb is truncated");
  return {begin, size};
}

void check_version(const nlohmann::json& json, const std::string& file_name) {
  const JsonFields root(json, file_name, "");
  if (!root.has("asset")) throw FileError(file_name, "not glTF: it has no 'asset'");
  const std::string version = root.object("asset").text("version");
  if (!version.starts_with("2.")) {
    throw FileError(file_name, "is not glTF version 2 but '" + version.substr(0, 16) + "'");
  }
}

}  // namespace

GltfDocument parse_gltf(std::string bytes, const std::string& file_name) {
  GltfDocument document;
  Chunk json{0, bytes.size()};
  if (bytes.starts_with(kMagic)) {
    document.binary_container = true;
    if (bytes.size() < kHeader) throw FileError(file_name, "the .glb is truncated");
    if (read_u32(bytes, 4) != 2) throw FileError(file_name, "is not a .glb of version 2");
    json = read_chunk(bytes, kHeader, kJsonChunk, file_name);
    const std::size_t end = json.begin + json.size;
    if (bytes.size() >= end + kChunkHeader) {
      const Chunk bin = read_chunk(bytes, end, kBinChunk, file_name);
      document.bin_begin = bin.begin;
      document.bin_size = bin.size;
    }
  }
  document.json = parse_json(std::string_view(bytes).substr(json.begin, json.size), file_name);
  check_version(document.json, file_name);
  document.bytes = std::move(bytes);
  return document;
}

std::string serialize(const GltfDocument& document, const std::string& file_name) {
  std::string json = document.json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (!document.binary_container) return json;

  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::size_t bin = (document.bin_size + 3) / 4 * 4;
  const std::size_t total =
      kHeader + kChunkHeader + json.size() + (bin > 0 ? kChunkHeader + bin : 0);
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    throw FileError(file_name, "is larger than a .glb can be");
  }
  std::string out;
  out.reserve(total);
  out += kMagic;
  append_u32(out, 2);
  append_u32(out, static_cast<std::uint32_t>(total));
  append_u32(out, static_cast<std::uint32_t>(json.size()));
  append_u32(out, kJsonChunk);
  out += json;
  if (bin > 0) {
    append_u32(out, static_cast<std::uint32_t>(bin));
    append_u32(out, kBinChunk);
    out.append(document.bytes, document.bin_begin, document.bin_size);
    out.resize(total, '\0');
  }
  return out;
}

}  // namespace relumbre
