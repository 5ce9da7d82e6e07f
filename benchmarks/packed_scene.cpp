#include "packed_scene.h"

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "relumbre/base/temporary_folder.h"
#include "relumbre/scene/import.h"

namespace relumbre::bench {

namespace fs = std::filesystem;

std::string data_folder() {
  const char* folder = std::getenv("RELUMBRE_DATA");
  return folder != nullptr ? folder : "../shared/data";
}

std::optional<Scene> read_packed_scene(const std::string& file, const std::string& companion) {
  const fs::path source = fs::path(data_folder()) / (file + ".xz");
  if (!fs::exists(source)) return std::nullopt;
  const TemporaryFolder folder;
  const fs::path unpacked = folder / fs::path(file).filename().string();
  const std::string command = fmt::format("xz -dc '{}' > '{}'", source.string(), unpacked.string());
  if (std::system(command.c_str()) != 0) return std::nullopt;
  if (!companion.empty()) {
    const fs::path beside = fs::path(data_folder()) / companion;
    fs::copy_file(beside, folder / beside.filename().string());
  }
  return import_scene(unpacked).scene;
}

}  // namespace relumbre::bench
