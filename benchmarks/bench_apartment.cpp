// A real interior, end to end: bake, relight and look at the apartment of the data folder, with the
// ceiling that it lacks. Writes apartment.glb, apartment.h5 and apartment-*.png beside the JSON.

#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "packed_scene.h"
#include "relumbre/image/image_io.h"
#include "relumbre/radiosity/seen_area.h"
#include "relumbre/render/response_cache.h"
#include "relumbre/render/view.h"
#include "relumbre/scene/gltf_writer.h"
#include "relumbre/store/bake.h"
#include "relumbre/store/store.h"
#include "report.h"

namespace relumbre::bench {
namespace {

namespace fs = std::filesystem;

/// Of this process so far, bytes; `reset` starts it anew (Linux).
std::size_t peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoul(line.substr(6)) * 1024;
  }
  return 0;
}
void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// A white quad just above everything, facing down.
void add_ceiling(Scene& scene) {
  const Box box = bounds(scene.mesh.positions);
  const float y = box.upper.y + 0.001F;
  const auto first = static_cast<std::uint32_t>(scene.mesh.positions.size());
  for (const auto& [x, z] : {std::pair{box.lower.x, box.lower.z},
                             {box.upper.x, box.lower.z},
                             {box.upper.x, box.upper.z},
                             {box.lower.x, box.upper.z}}) {
    scene.mesh.positions.emplace_back(x, y, z);
  }
  if (!scene.texcoords.empty()) scene.texcoords.resize(scene.mesh.positions.size());
  if (!scene.shading_normals.empty())
    scene.shading_normals.resize(scene.mesh.positions.size(), {0, -1, 0});
  scene.materials.push_back({.name = "added ceiling", .reflectance = Rgb(0.8F)});
  scene.objects.push_back({"added ceiling"});
  for (const Index3& t :
       {Index3{first, first + 1, first + 2}, Index3{first, first + 2, first + 3}}) {
    scene.mesh.triangles.push_back(t);
    scene.mesh.material.push_back(static_cast<std::uint32_t>(scene.materials.size() - 1));
    scene.mesh.object.push_back(static_cast<std::uint32_t>(scene.objects.size() - 1));
    scene.mesh.two_sided.push_back(0);
  }
}

/// A ceiling panel in every room, two more in the living room; warm and cool by turns.
std::vector<Light> panels(const Scene& scene) {
  const float y = bounds(scene.mesh.positions).upper.y - 0.02F;
  constexpr float kSide = 0.6F;
  std::vector<Light> lights;
  for (const auto& [x, z] : {std::pair{8.6F, -6.3F},
                             {11.2F, -6.3F},
                             {9.8F, -4.1F},
                             {9.0F, -10.0F},
                             {5.6F, -8.0F},
                             {5.7F, -4.6F},
                             {5.5F, -10.6F}}) {
    Light light;
    light.name = fmt::format("panel {}", lights.size() + 1);
    light.type = LightType::kQuad;
    light.position = {x - kSide / 2, y, z - kSide / 2};
    light.edge1 = {kSide, 0, 0};
    light.edge2 = {0, 0, kSide};
    light.color = lights.size() % 2 == 0 ? Rgb(1, 0.86F, 0.7F) : Rgb(0.85F, 0.93F, 1);
    light.intensity = 60;
    lights.push_back(light);
  }
  return lights;
}

/// Bakes and reports time and memory.
void bake_it(const Scene& scene, const fs::path& store, const BakeConfig& config, Report& report) {
  const BakeEstimate estimate = estimate_bake(scene, config);
  reset_peak_memory();
  const std::size_t before = peak_memory();
  double seconds = 0;
  BakeResult result;
  const std::function<void()> once = [&] { result = bake(scene, config, store); };
  seconds = seconds_of(once);
  const auto counts =
      static_cast<double>(result.nonzeros) * 8 + static_cast<double>(config.elements) * 8;
  report.figure("bake, s", seconds, "s");
  report.figure("tracing, Mray/s",
                static_cast<double>(config.elements) * config.rays / result.trace_seconds / 1e6,
                "Mray/s");
  report.figure("peak memory of the bake, MB", static_cast<double>(peak_memory()) / 1e6, "MB");
  report.figure("memory before it, MB", static_cast<double>(before) / 1e6, "MB");
  report.figure("predicted peak, MB", static_cast<double>(estimate.peak_bytes()) / 1e6, "MB");
  report.figure("counts, MB", counts / 1e6, "MB");
  report.figure("scene, MB", static_cast<double>(estimate.scene_bytes) / 1e6, "MB");
  const auto peak = static_cast<double>(peak_memory());
  const auto held = static_cast<double>(estimate.scene_bytes);
  const auto table = static_cast<double>(config.elements) * static_cast<double>(config.patches);
  report.figure("counts as the 8-bit table that relights, MB", table / 1e6, "MB");
  report.figure("peak / (8-bit table + scene)", peak / (table + held), "");
  report.figure("peak / (sparse counts + scene)", peak / (counts + held), "");
  report.figure("rays that left the scene", result.energy.escaped, "");
}

void relight_and_look(const fs::path& folder, const BakedScene& baked, Report& report) {
  const RayScene rays(baked.scene.mesh);
  const std::vector<float> weights = seen_area(baked.counts, baked.tessellation.area);
  const auto relight_operator = make_compressed_operator(
      {baked.counts, baked.tessellation.patch_offsets, weights, baked.reflectance},
      CountFormat::kCounts8);
  std::vector<Light> lights = panels(baked.scene);
  ResponseCache cache(baked.scene, baked.tessellation, rays);
  const std::vector<LightResponse> responses = cache.responses(lights);

  RelitResult lit;
  const std::function<void()> frame = [&] {
    lit = relight(baked.scene, baked.tessellation, baked.reflectance, baked.emission,
                  *relight_operator, lights, responses);
  };
  const double seconds = median_seconds(std::span(&frame, 1), 20)[0];
  report.figure("relight with 7 lamps, ms", seconds * 1e3, "ms");
  report.figure("relight rate, Hz", 1 / seconds, "Hz");

  const DisplayMesh display = conforming_mesh(baked.tessellation);
  const LitScene view{baked.scene, baked.tessellation, display, rays, baked.reflectance, lights,
                      lit};
  const std::pair<const char*, Camera> cameras[] = {
      {"living", {"", {7.15F, 1.6F, -5.35F}, {11.0F, 0.9F, -6.4F}, {0, 1, 0}, 65}},
      {"kitchen", {"", {12.1F, 1.6F, -7.3F}, {8.7F, 0.9F, -3.4F}, {0, 1, 0}, 65}},
      {"bedroom", {"", {7.4F, 1.6F, -8.6F}, {9.9F, 0.6F, -11.0F}, {0, 1, 0}, 65}}};
  for (const auto& [name, camera] : cameras) {
    ViewConfig config;
    config.width = 960, config.height = 540, config.samples = 4;
    config.mode = ViewMode::kDirectPerPixel;
    const Image image = render_view(view, camera, config);
    save_image(folder / fmt::format("apartment-{}.png", name), image, {.auto_exposure = true});
  }
}

int run(int argc, char** argv) {
  Report report("apartment", argc, argv);
  auto apartment = read_packed_scene("interior/apartment.obj", "interior/apartment.mtl");
  if (!apartment) {
    report.note("skipped: no interior/apartment.obj.xz in RELUMBRE_DATA");
    return report.finish();
  }
  Scene scene = std::move(*apartment);
  add_ceiling(scene);
  const fs::path folder = fs::path(report.option("output", "./apartment.json")).parent_path();
  write_gltf(folder / "apartment.glb", scene);
  BakeConfig config;
  config.elements = std::stoul(report.option("elements", "200000"));
  config.patches = std::stoul(report.option("patches", "2000"));
  config.rays = static_cast<std::uint32_t>(std::stoul(report.option("rays", "512")));
  config.scene_name = "apartment";
  bake_it(scene, folder / "apartment.h5", config, report);
  relight_and_look(folder, read_store(folder / "apartment.h5"), report);
  return report.finish();
}

}  // namespace
}  // namespace relumbre::bench

int main(int argc, char** argv) {
  return relumbre::bench::run_benchmark(relumbre::bench::run, argc, argv);
}
