/// Baked scenes made by hand and helpers to damage files, for the tests of this module.
#pragma once

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <sys/resource.h>

#include "relumbre/base/error.h"
#include "relumbre/store/baked_scene.h"

namespace relumbre {

/// Two triangles, the first cut once: five facets in four elements in two patches. Every kind of
/// thing that a store holds is there.
inline BakedScene hand_made_scene() {
  BakedScene baked;
  Scene& scene = baked.scene;
  scene.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1F, 0.2F, 3}, {1, 0, 3}, {0, 1, 3}};
  scene.mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
  scene.mesh.material = {0, 1};
  scene.mesh.object = {1, 0};
  scene.mesh.two_sided = {0, 0};
  scene.texcoords = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {0.3F, 0}, {0, 1}};
  scene.shading_normals.assign(6, Vec3f(0, 0, 1));
  scene.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5F, 0.25F, 1}, {1, 1, 1}, {0, 0, 0}};
  scene.materials = {{"wall \"white\"", Rgb(0.7F, 0.1F, 0.99F), Rgb(), 1, false},
                     {"lámpara", Rgb(0.2F), Rgb(10, 9, 8), kNone, true}};
  scene.textures = {{"plain", 1, 1, {1, 2, 3}}, {"stripes", 2, 1, {255, 0, 7, 9, 128, 64}}};
  scene.objects = {{"lamp"}, {"wall"}};
  Light spot;
  spot.name = "spot";
  spot.type = LightType::kSpot;
  spot.position = {0.5F, 0.25F, 2};
  spot.inner_deg = 12.5F;
  spot.color = {1, 0.3F, 0.1F};
  spot.intensity = 42;
  spot.on = false;
  Light emitter;
  emitter.name = "lamp";
  emitter.type = LightType::kEmitter;
  emitter.object = 0;
  scene.lights = {spot, emitter};
  scene.cameras = {{"front", {0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 33.3F}};

  Tessellation& t = baked.tessellation;
  t.positions = scene.mesh.positions;
  t.positions.insert(t.positions.end(), {{0.5F, 0, 0}, {0, 0.5F, 0}, {0.5F, 0.5F, 0}});
  t.facets = {{{0, 6, 7}, 0, 0},
              {{6, 1, 8}, 0, 0},
              {{7, 8, 2}, 0, 0},
              {{8, 7, 6}, 0, 0},
              {{3, 5, 4}, 1, 0}};
  t.facet_offsets = {0, 1, 3, 4, 5};
  t.patch_offsets = {0, 3, 4};
  t.area = {0.125F, 0.25F, 0.125F, 0.5F};
  t.centroid = {{0.2F, 0.2F, 0}, {0.4F, 0.4F, 0}, {0.3F, 0.3F, 0}, {0.3F, 0.3F, 3}};
  t.normal = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, -1}};
  t.locator.roots = {0, FacetLocator::kMissing, ~4, FacetLocator::kMissing};
  t.locator.nodes = {~0, ~1, ~2, ~3};

  baked.reflectance = {Rgb(0.7F), Rgb(0.1F, 0.2F, 0.3F), Rgb(0.99F), Rgb(0)};
  baked.emission = {Rgb(), Rgb(), Rgb(), Rgb(10, 9, 8)};
  baked.counts.columns = 2;
  baked.counts.rays = 16;
  baked.counts.row_offsets = {0, 1, 1, 2, 4};
  baked.counts.column = {1, 1, 0, 1};
  baked.counts.count = {5, 16, 7, 1};
  baked.settings = {"hand-made", PatchMethod::kHierarchy, 2, 4, 16, 0xFFFFFFFFFFFFFFFFU};
  baked.energy.elements = 4;
  baked.energy.rays = 64;
  baked.energy.reciprocity_error = 0.125;
  baked.energy.escaped = 1.0 / 3;
  return baked;
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void put_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// The message of the FileError that `action` throws; "" if it throws none.
template <class Action>
std::string file_error(Action&& action) {
  try {
    action();
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

inline std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

/// While it lives no file can grow beyond `bytes`: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

}  // namespace relumbre
