// Feeds arbitrary bytes to import_scene as a file of the kind its first bytes suggest: a scene with
// finite triangles or an Error must come of it. Only what Relumbre does is instrumented; Assimp is
// the system's.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/scene/import.h"

namespace {

const char* file_name(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return "fuzz.glb";
  if (bytes.starts_with('{')) return "fuzz.gltf";
  if (bytes.starts_with("ply")) return "fuzz.ply";
  if (bytes.starts_with("solid") || bytes.find('\0') != std::string_view::npos) return "fuzz.stl";
  return "fuzz.obj";
}

}  // namespace

// Assimp leaks what it has read when it gives up on a file.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const relumbre::TemporaryFolder folder;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto file = folder / file_name(bytes);
  std::ofstream(file, std::ios::binary) << bytes;
  try {
    const relumbre::Scene scene = relumbre::import_scene(file).scene;
    if (scene.mesh.triangles.empty()) std::abort();
    for (const relumbre::Vec3f& position : scene.mesh.positions) {
      if (!relumbre::is_finite(position)) std::abort();
    }
  } catch (const relumbre::Error&) {
  }
  return 0;
}
