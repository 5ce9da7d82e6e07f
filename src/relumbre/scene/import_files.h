/// Which files the mesh importer may see. Internal to the import.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <assimp/DefaultIOSystem.h>

namespace relumbre {

enum class SceneKind { kObj, kPly, kStl, kGltf };

/// Kind by extension; a file that is missing, empty, or plainly not what its extension says is
/// refused: PLY shorter than its header claims, STL shorter than its triangle count, OBJ that is
/// not text. Throws FileError.
SceneKind check_scene_file(const std::filesystem::path& file);

/// Assimp's view of the disk: regular files only (no devices, no pipes), read-only. The scene file
/// itself may be served from memory; files that could not be opened are remembered.
class SceneFiles final : public Assimp::DefaultIOSystem {
 public:
  /// `content` stands in for `file` where it is not empty; it must outlive this.
  SceneFiles(std::filesystem::path file, const std::string& content)
      : file_(std::move(file)), content_(content) {}

  bool Exists(const char* file) const override;
  Assimp::IOStream* Open(const char* file, const char* mode) override;

  [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }

 private:
  std::filesystem::path file_;
  const std::string& content_;
  std::vector<std::string> missing_;
};

}  // namespace relumbre
