#include "relumbre/scene/import_files.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

#include <assimp/MemoryIOWrapper.h>

#include "relumbre/base/error.h"
#include "relumbre/scene/import.h"
#include "relumbre/scene/ply_header.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

std::optional<SceneKind> kind_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".obj") return SceneKind::kObj;
  if (extension == ".ply") return SceneKind::kPly;
  if (extension == ".stl") return SceneKind::kStl;
  if (extension == ".gltf" || extension == ".glb") return SceneKind::kGltf;
  return std::nullopt;
}

std::string read_range(const fs::path& file, std::uintmax_t begin, std::uintmax_t size) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.seekg(static_cast<std::streamoff>(begin));
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (bytes.size() < size) throw FileError(file.string(), "cannot be read");
  return bytes;
}

void check_obj(const fs::path& file, std::uintmax_t size) {
  const std::string head = read_range(file, 0, std::min<std::uintmax_t>(size, 4096));
  if (head.find('\0') != std::string::npos)
    throw FileError(file.string(), "is not an OBJ text file");
}

/// Binary STL is an 80-byte title, a 32-bit count, and 50 bytes a triangle; text STL is everything
/// between "solid" and "endsolid".
void check_stl(const fs::path& file, std::uintmax_t size) {
  constexpr std::uintmax_t title = 80, header = 84, triangle = 50, tail = 512;
  if (size >= header) {
    const std::string count_bytes = read_range(file, title, 4);
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      count |= std::uint64_t{static_cast<std::uint8_t>(count_bytes[i])} << (8 * i);
    }
    if (size == header + triangle * count) return;
  }
  if (!read_range(file, 0, std::min<std::uintmax_t>(size, 5)).starts_with("solid")) {
    throw FileError(file.string(), "is not STL, or truncated: its size does not fit its count");
  }
  const std::uintmax_t last = std::min(size, tail);
  if (read_range(file, size - last, last).find("endsolid") == std::string::npos) {
    throw FileError(file.string(), "is a truncated text STL: it does not end with endsolid");
  }
}

}  // namespace

SceneKind check_scene_file(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw FileError(file.string(), "no such file");
  if (!fs::is_regular_file(status)) throw FileError(file.string(), "is not a regular file");
  const std::optional<SceneKind> kind = kind_of(file);
  if (!kind) throw FileError(file.string(), "is not one of .obj .ply .stl .gltf .glb");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw FileError(file.string(), error.message());
  if (size == 0) throw FileError(file.string(), "is empty");
  if (kind == SceneKind::kObj) check_obj(file, size);
  if (kind == SceneKind::kPly) check_ply(file, size);
  if (kind == SceneKind::kStl) check_stl(file, size);
  return *kind;
}

bool can_import(const fs::path& file) { return kind_of(file).has_value(); }

bool SceneFiles::Exists(const char* file) const {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

Assimp::IOStream* SceneFiles::Open(const char* file, const char* mode) {
  if (std::strpbrk(mode, "wa+") != nullptr) return nullptr;
  if (!content_.empty() && fs::path(file).lexically_normal() == file_.lexically_normal()) {
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()),
                                      content_.size());
  }
  Assimp::IOStream* stream = Exists(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
  if (stream == nullptr && std::ranges::find(missing_, file) == missing_.end()) {
    missing_.emplace_back(file);
  }
  return stream;
}

}  // namespace relumbre
