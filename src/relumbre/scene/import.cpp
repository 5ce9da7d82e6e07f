#include "relumbre/scene/import.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <memory>
#include <unordered_set>
#include <utility>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/geometry/clean.h"
#include "relumbre/scene/gltf_document.h"
#include "relumbre/scene/gltf_extras.h"
#include "relumbre/scene/gltf_reduce.h"
#include "relumbre/scene/import_files.h"
#include "relumbre/scene/import_meshes.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

/// Appends ".2", ".3", ... to a name that is taken already.
class UniqueNames {
 public:
  std::string take(std::string name) {
    std::string unique = name;
    for (std::size_t i = 2; !taken_.insert(unique).second; ++i) {
      unique = name + "." + std::to_string(i);
    }
    return unique;
  }

 private:
  std::unordered_set<std::string> taken_;
};

/// What a glTF file brings beside its meshes, and the text Assimp is given instead of the file.
struct GltfParts {
  std::string content;
  std::vector<GltfMaterial> materials;
  GltfExtras extras;
};

GltfParts prepare_gltf(const fs::path& file, const ImportConfig& config, ImportReport& report) {
  GltfDocument document = parse_gltf(read_file(file), file.string());
  ReducedGltf reduced =
      reduce_gltf(document, file.parent_path(), file.string(), config.default_reflectance);
  GltfParts parts;
  parts.extras =
      read_gltf_extras(document.json, file.string(), {config.scale, config.photometric_lights});
  parts.materials = std::move(reduced.materials);
  document.json = std::move(reduced.json);
  parts.content = serialize(document, file.string());
  report.points_and_lines += reduced.points_and_lines;
  report.warnings = std::move(reduced.warnings);
  report.warnings.insert(report.warnings.end(), parts.extras.warnings.begin(),
                         parts.extras.warnings.end());
  return parts;
}

std::string one_line(std::string message) {
  std::ranges::replace_if(
      message, [](unsigned char c) { return c < 0x20; }, ' ');
  return message.empty() ? "cannot be read as a scene" : message;
}

std::unique_ptr<aiScene> read_with_assimp(const fs::path& file, const std::string& content,
                                          ImportReport& report) {
  Assimp::Importer importer;
  auto* const files = new SceneFiles(file, content);
  importer.SetIOHandler(files);  // which owns it from here on
  std::string problem;
  try {
    // No post-processing: Assimp's steps trust indices that import_meshes has yet to check.
    importer.ReadFile(file.string(), 0);
    problem = importer.GetErrorString();
  } catch (const std::exception& error) {
    problem = error.what();
  }
  for (const std::string& name : files->missing()) {
    report.warnings.push_back(name + ": cannot be opened; what it describes is left out");
  }
  std::unique_ptr<aiScene> scene(importer.GetOrphanedScene());
  if (!scene || scene->mRootNode == nullptr) throw FileError(file.string(), one_line(problem));
  return scene;
}

void clean_mesh(const fs::path& file, Scene& scene, ImportReport& report) {
  const CleanReport cleaned = clean(scene.mesh);
  report.degenerate = cleaned.degenerate;
  report.duplicate = cleaned.duplicate;
  report.non_finite = cleaned.non_finite;
  if (!scene.mesh.triangles.empty()) return;
  throw FileError(file.string(), cleaned.dropped() == 0
                                     ? "holds no triangles"
                                     : "holds no usable triangles (all " +
                                           std::to_string(cleaned.dropped()) + " dropped)");
}

/// One kEmitter for every object that has an emissive triangle left.
std::vector<Light> emitters(const Scene& scene) {
  std::vector<std::uint8_t> emissive(scene.objects.size(), 0);
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t) {
    if (scene.materials[scene.mesh.material[t]].emissive()) emissive[scene.mesh.object[t]] = 1;
  }
  std::vector<Light> lights;
  for (std::size_t o = 0; o < emissive.size(); ++o) {
    if (emissive[o] == 0) continue;
    Light light;
    light.name = scene.objects[o].name;
    light.type = LightType::kEmitter;
    light.object = static_cast<std::uint32_t>(o);
    lights.push_back(std::move(light));
  }
  return lights;
}

void name_objects(Scene& scene, const fs::path& file) {
  UniqueNames names;
  for (Object& object : scene.objects) {
    object.name = names.take(object.name.empty() ? file.stem().string() : object.name);
  }
}

/// Emitters first take their objects' names, so that these stay what the user sees elsewhere.
void add_lights(Scene& scene, std::vector<Light> punctual) {
  UniqueNames names;
  std::vector<Light> emitting = emitters(scene);
  for (Light& light : emitting) light.name = names.take(light.name);
  for (Light& light : punctual) light.name = names.take(light.name);
  scene.lights = std::move(punctual);
  std::ranges::move(emitting, std::back_inserter(scene.lights));
}

void check(const ImportConfig& config) {
  if (!(config.scale > 0) || !std::isfinite(config.scale)) {
    throw ValueError("import: a scale of " + std::to_string(config.scale) + " is not positive");
  }
  if (!(config.default_reflectance >= 0 && config.default_reflectance <= 1)) {
    throw ValueError("import: a default reflectance of " +
                     std::to_string(config.default_reflectance) + " is not in [0, 1]");
  }
}

}  // namespace

ImportResult import_scene(const fs::path& file, const ImportConfig& config, Progress& progress) {
  check(config);
  ImportResult result;
  Scene& scene = result.scene;
  progress.begin("import", 4);
  const auto step = [&progress] {
    progress.advance(1);
    progress.check();
  };

  // What must hold before a parser sees the file.
  const SceneKind kind = check_scene_file(file);
  GltfParts gltf;
  if (kind == SceneKind::kGltf) gltf = prepare_gltf(file, config, result.report);
  step();

  std::unique_ptr<aiScene> source = read_with_assimp(file, gltf.content, result.report);
  gltf.content = {};
  step();

  // Triangles in world space; the source goes as it is converted.
  import_meshes(std::move(source), kind, file, config, gltf.materials, result);
  step();

  clean_mesh(file, scene, result.report);
  name_objects(scene, file);
  add_lights(scene, std::move(gltf.extras.lights));
  scene.cameras = std::move(gltf.extras.cameras);
  progress.advance(1);
  return result;
}

}  // namespace relumbre
