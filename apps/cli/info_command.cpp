#include <filesystem>

#include "cli/energy.h"
#include "cli/octree_report.h"
#include "cli/reference.h"
#include "cli/scene_input.h"

namespace relumbre::cli {

namespace {

struct Options {
  StoreOptions store;
  ReferenceOptions reference;
  bool error = false, devices = false;
};

void describe_scene(const std::string& file, Session& session) {
  SceneOptions options;
  options.file = file;
  const Scene scene = import_and_report(options, session);
  session.report.section("materials", "Materials");
  for (const Material& m : scene.materials) {
    session.report.figure(
        m.name, m.name,
        nlohmann::json{{"reflectance", {m.reflectance.x, m.reflectance.y, m.reflectance.z}},
                       {"emission", {m.emission.x, m.emission.y, m.emission.z}},
                       {"two_sided", m.two_sided}},
        fmt::format("{:.3f} {:.3f} {:.3f}{}{}", m.reflectance.x, m.reflectance.y, m.reflectance.z,
                    m.two_sided ? ", two-sided" : "", m.emissive() ? ", emissive" : ""));
  }
}

void describe_store(const std::string& file, Session& session) {
  const StoreSummary store = read_store_summary(file);
  Report& report = session.report;
  report.section("store", file);
  report.figure("scene", "scene", store.settings.scene);
  report.figure("elements", "elements n", store.settings.elements,
                grouped(store.settings.elements));
  report.figure("patches", "patches k", store.settings.patches, grouped(store.settings.patches));
  report.figure("method", "method",
                store.settings.method == PatchMethod::kHierarchy ? "hierarchy" : "cluster");
  report.figure("rays", "rays per element", store.settings.rays);
  report.figure("seed", "seed", store.settings.seed);
  report.figure("triangles", "triangles", store.triangles, grouped(store.triangles));
  report.figure("facets", "facets", store.facets, grouped(store.facets));
  report.figure("nonzeros", "counts", store.nonzeros, grouped(store.nonzeros));
  report.figure("file_bytes", "file", store.file_bytes, bytes_text(store.file_bytes));
  report.figure("geometry_hash", "scene hash", fmt::format("{:016x}", store.geometry_hash));
  report.section("energy", "Energy");
  report_energy(store.energy, session);
}

void describe_error(const Options& options, Session& session) {
  session.report.section("lighting", "Error of the compressed operator under this lighting");
  const OpenedStore store(options.store, session);
  const Reference reference = solve_reference(store, options.reference, session);
  session.report.section("error", "Compressed against the reference");
  report_error(compressed_error(store, reference, session), session);
}

void describe_octree(const std::string& file, Session& session) {
  session.report.section("octree", file);
  report_octree(read_rlo(file), session);
}

void run(const Options& options, Session& session) {
  if (options.devices) report_devices(session);
  if (options.store.store.empty()) {
    if (options.devices) return;
    throw CLI::RequiredError("store");
  }
  if (std::filesystem::path(options.store.store).extension() == ".rlo")
    return describe_octree(options.store.store, session);
  if (can_import(options.store.store)) return describe_scene(options.store.store, session);
  describe_store(options.store.store, session);
  if (options.error) describe_error(options, session);
}

}  // namespace

void add_info_command(CLI::App& app) {
  add_command<Options>(
      app, "info", "What a scene, store or octree holds, and the error of a store's compression",
      "relumbre info cornell.h5 --error",
      [](CLI::App& command, Options& o) {
        add_store_options(command, o.store);
        command.get_option("store")->required(false)->description(
            "A store, an octree (.rlo), or a scene: .gltf, .glb, .obj, .ply, .stl");
        add_reference_options(command, o.reference);
        command.add_flag("--devices", o.devices, "List what --device may name");
        command.add_flag("--error", o.error,
                         "Solve element to element and compare (traces rays; takes a while)");
      },
      run);
}

}  // namespace relumbre::cli
