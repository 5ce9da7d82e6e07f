#include "cli/opened_store.h"

#include <map>

#include "relumbre/base/error.h"
#include "relumbre/radiosity/seen_area.h"
#include "relumbre/render/response_cache.h"
#include "relumbre/scene/element_materials.h"
#include "relumbre/scene/lights_json.h"

namespace relumbre::cli {

namespace {

const std::map<std::string, CountFormat> kFormats = {{"counts8", CountFormat::kCounts8},
                                                     {"counts16", CountFormat::kCounts16},
                                                     {"float16", CountFormat::kFloat16},
                                                     {"float32", CountFormat::kFloat32}};

/// "material=r,g,b" applied to the scene's material of that name.
void edit_reflectance(Scene& scene, const std::string& edit) {
  const std::size_t equals = edit.rfind('=');
  Rgb value;
  int read = 0;
  if (equals == std::string::npos ||
      std::sscanf(edit.c_str() + equals + 1, "%f,%f,%f%n", &value.x, &value.y, &value.z, &read) !=
          3 ||
      equals + 1 + static_cast<std::size_t>(read) != edit.size()) {
    throw ValueError("--reflectance " + edit + ": must read MATERIAL=R,G,B");
  }
  for (std::size_t c = 0; c < 3; ++c) {
    if (!(value[c] >= 0 && value[c] <= kMaxReflectance)) {
      throw ValueError(fmt::format("--reflectance {}: must lie in [0, {}]", edit, kMaxReflectance));
    }
  }
  const std::string name = edit.substr(0, equals);
  for (Material& material : scene.materials) {
    if (material.name == name) {
      material.reflectance = value;
      return;
    }
  }
  throw ValueError("--reflectance " + edit + ": the scene has no material of that name");
}

BakedScene open_store(const StoreOptions& options, Session& session) {
  const Stopwatch watch;
  BakedScene baked = read_store(options.store);
  for (const std::string& edit : options.reflectance) edit_reflectance(baked.scene, edit);
  if (!options.reflectance.empty()) {
    baked.reflectance = element_materials(baked.scene, baked.tessellation).reflectance;
  }
  session.report.note(options.store);
  session.report.figure("elements", "elements n", baked.tessellation.elements(),
                        grouped(baked.tessellation.elements()));
  session.report.figure("patches", "patches k", baked.tessellation.patches(),
                        grouped(baked.tessellation.patches()));
  session.report.figure("load_s", "store opened in", watch.seconds(),
                        seconds_text(watch.seconds()));
  return baked;
}

}  // namespace

void add_store_options(CLI::App& command, StoreOptions& o, const std::string& name) {
  command.add_option(name, o.store, "A store written by `relumbre bake`")
      ->required(name == "store");
  auto* lights =
      command.add_option("--lights", o.lights, "lights.json: lights beside the scene's own");
  command
      .add_option("--emission", o.emission,
                  "E.npy of shape (n,3) or (m,n,3), in W/m², instead of lights")
      ->excludes(lights);
  command.add_flag("--no-scene-lights", o.no_scene_lights, "Leave the scene's own lights off");
  command
      .add_option("--points", o.direct.points_per_element, "Points per element for direct light")
      ->capture_default_str();
  command
      .add_option("--light-samples", o.direct.light_samples,
                  "Shadow rays per point to a light with a surface")
      ->capture_default_str();
  command.add_option("--sky-samples", o.direct.sky_samples, "Shadow rays per point to a sky")
      ->capture_default_str();
  command.add_flag("--no-cache", o.no_cache, "Do not keep light responses in STORE.lights/");
  command.add_option("--format", o.format, "How the operator holds U in memory")
      ->check(CLI::IsMember({"counts8", "counts16", "float16", "float32"}))
      ->capture_default_str();
  command.add_option("--reflectance", o.reflectance,
                     "MATERIAL=R,G,B: change a reflectance without tracing (repeatable)");
}

OpenedStore::OpenedStore(const StoreOptions& options, Session& session)
    : processor(make_processor(options.device, session)),
      baked(open_store(options, session)),
      rays(processor->ray_scene(baked.scene.mesh)),
      options_(options) {
  if (has_emission()) return;
  std::vector<Light> extra;
  if (!options.lights.empty()) extra = read_lights(options.lights, baked.scene);
  lights = combine_lights(baked.scene.lights, extra, !options.no_scene_lights);
  if (lights.empty()) {
    throw ValueError(options.store +
                     ": there are no lights; give --lights lights.json or --emission E.npy");
  }
}

std::vector<LightResponse> OpenedStore::responses(Session& session) const {
  const Stopwatch watch;
  ResponseCache cache(baked.scene, baked.tessellation, rays, options_.direct,
                      options_.no_cache ? std::string() : options_.store + ".lights");
  std::vector<LightResponse> all = cache.responses(lights, session.progress);
  session.progress.clear();
  session.report.figure("lights", "lights", lights.size());
  session.report.figure("light_rays", "shadow rays", cache.counters().rays,
                        grouped(cache.counters().rays));
  session.report.figure("direct_s", "direct light in", watch.seconds(),
                        seconds_text(watch.seconds()));
  return all;
}

std::unique_ptr<RelightOperator> OpenedStore::make_operator(Session& session) const {
  const Stopwatch watch;
  const std::vector<float> weights = seen_area(baked.counts, baked.tessellation.area);
  auto made = processor->relight_operator(
      {baked.counts, baked.tessellation.patch_offsets, weights, baked.reflectance},
      kFormats.at(options_.format));
  session.report.figure("operator_s", "operator made in", watch.seconds(),
                        seconds_text(watch.seconds()));
  session.report.figure("operator_bytes", "bytes read per relight", made->bytes_per_apply(),
                        bytes_text(made->bytes_per_apply()));
  return made;
}

RelitResult OpenedStore::relight(Session& session) const {
  const std::vector<LightResponse> direct = responses(session);
  const auto relight_operator = make_operator(session);
  const auto once = [&] {
    return relumbre::relight(baked.scene, baked.tessellation, baked.reflectance, baked.emission,
                             *relight_operator, lights, direct);
  };
  once();  // warms caches, so that the time below is what a frame takes
  const Stopwatch watch;
  RelitResult lit = once();
  session.report.figure("relight_s", "relit in", watch.seconds(), seconds_text(watch.seconds()));
  return lit;
}

std::vector<Rgb> OpenedStore::reflected(Session& session) const {
  const std::vector<LightResponse> direct = responses(session);
  std::vector<Rgb> light = direct_irradiance(baked.tessellation.elements(), lights, direct);
  for (std::size_t i = 0; i < light.size(); ++i) light[i] *= baked.reflectance[i];
  return light;
}

FloatArray OpenedStore::read_emission() const {
  FloatArray array = read_npy(options_.emission);
  const std::size_t n = baked.tessellation.elements(), rank = array.shape.size();
  if ((rank != 2 && rank != 3) || array.shape[rank - 1] != 3 || array.shape[rank - 2] != n) {
    std::string shape;
    for (const std::size_t extent : array.shape)
      shape += (shape.empty() ? "" : ",") + std::to_string(extent);
    throw FileError(options_.emission,
                    fmt::format("has shape ({}) where ({},3) or (m,{},3) is needed", shape, n, n));
  }
  for (const float value : array.data) {
    if (!std::isfinite(value)) throw FileError(options_.emission, "holds a NaN or an infinity");
  }
  return array;
}

std::span<float> flat(std::vector<Rgb>& values) {
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  return values.empty() ? std::span<float>() : std::span<float>(&values[0].x, values.size() * 3);
}

std::span<const float> flat(const std::vector<Rgb>& values) {
  return values.empty() ? std::span<const float>()
                        : std::span<const float>(&values[0].x, values.size() * 3);
}

}  // namespace relumbre::cli
