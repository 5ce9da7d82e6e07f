#include "cli/scene_input.h"

#include <map>

#include "relumbre/base/box.h"

namespace relumbre::cli {

namespace {

const std::map<std::string, Sides> kSides = {
    {"auto", Sides::kAuto}, {"one", Sides::kOne}, {"two", Sides::kTwo}};

void report_dropped(const ImportReport& dropped, Session& session) {
  session.report.figure(
      "dropped", "dropped triangles",
      nlohmann::json{{"degenerate", dropped.degenerate},
                     {"duplicate", dropped.duplicate},
                     {"non_finite", dropped.non_finite},
                     {"points_and_lines", dropped.points_and_lines}},
      fmt::format("{} degenerate, {} duplicate, {} not finite; {} points and lines",
                  dropped.degenerate, dropped.duplicate, dropped.non_finite,
                  dropped.points_and_lines));
  for (const std::string& warning : dropped.warnings) session.report.warn(warning);
}

}  // namespace

void add_scene_options(CLI::App& command, SceneOptions& o) {
  command.add_option("scene", o.file, "A scene: .gltf, .glb, .obj, .ply or .stl")->required();
  command
      .add_option("--sides", o.sides,
                  "Which sides reflect: auto (glTF: as its materials say; others: two), one, two")
      ->check(CLI::IsMember({"auto", "one", "two"}))
      ->capture_default_str();
  command.add_option("--scale", o.import.scale, "Metres per unit of the file")
      ->capture_default_str();
  command.add_flag("--photometric-lights", o.import.photometric_lights,
                   "glTF's punctual lights are in candela and lux, not W/sr and W/m²");
}

Scene import_and_report(const SceneOptions& options, Session& session) {
  ImportConfig config = options.import;
  config.sides = kSides.at(options.sides);
  const Stopwatch watch;
  ImportResult imported = import_scene(options.file, config, session.progress);
  session.progress.clear();
  session.report.section("scene", options.file);
  report_scene(imported.scene, session);
  report_dropped(imported.report, session);
  session.report.figure("import_s", "imported in", watch.seconds(), seconds_text(watch.seconds()));
  return std::move(imported.scene);
}

void report_scene(const Scene& scene, Session& session) {
  Report& report = session.report;
  const TriangleMesh& mesh = scene.mesh;
  const Vec3f size = bounds(mesh.positions).size();
  const auto two_sided =
      static_cast<std::size_t>(std::count(mesh.two_sided.begin(), mesh.two_sided.end(), 1));
  report.figure(
      "triangles", "triangles", mesh.triangles.size(),
      fmt::format("{} ({} two-sided)", grouped(mesh.triangles.size()), grouped(two_sided)));
  report.figure("size_m", "size", nlohmann::json{size.x, size.y, size.z},
                fmt::format("{:.3g} x {:.3g} x {:.3g} m", size.x, size.y, size.z));
  report.figure("objects", "objects", scene.objects.size());
  report.figure("materials", "materials", scene.materials.size(),
                fmt::format("{} ({} textures)", scene.materials.size(), scene.textures.size()));
  nlohmann::json names = nlohmann::json::array();
  std::string text;
  for (const Light& light : scene.lights) {
    names.push_back(light.name);
    text += (text.empty() ? ": " : ", ") + light.name;
  }
  report.figure("lights", "lights", names, fmt::format("{}{}", scene.lights.size(), text));
  report.figure("cameras", "cameras", scene.cameras.size());
}

}  // namespace relumbre::cli
