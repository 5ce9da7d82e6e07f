#include "cli/scene_input.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/radiosity/view_factors.h"

namespace relumbre::cli {

namespace {

struct Options {
  SceneOptions scene;
  ViewFactorConfig config;
  std::string output;
};

/// "from,to,factor,standard_error" for every pair, quoted names.
std::string csv(const Scene& scene, const ViewFactorResult& result) {
  std::string text = "from,to,view_factor,standard_error,area_from_m2\n";
  for (std::size_t i = 0; i < result.objects; ++i) {
    for (std::size_t j = 0; j < result.objects; ++j) {
      text += fmt::format("\"{}\",\"{}\",{:.9g},{:.3g},{:.9g}\n", scene.objects[i].name,
                          scene.objects[j].name, result.from_to(i, j), result.error_from_to(i, j),
                          result.area[i]);
    }
  }
  return text;
}

void report_pairs(const Scene& scene, const ViewFactorResult& result, Session& session) {
  session.report.note(fmt::format("  {:<20} {:<20} {:>11} {:>10}", "from", "to", "F", "std error"));
  nlohmann::json pairs = nlohmann::json::array();
  for (std::size_t i = 0; i < result.objects; ++i) {
    for (std::size_t j = 0; j < result.objects; ++j) {
      const double factor = result.from_to(i, j), error = result.error_from_to(i, j);
      pairs.push_back({{"from", scene.objects[i].name},
                       {"to", scene.objects[j].name},
                       {"factor", factor},
                       {"standard_error", error}});
      if (factor == 0) continue;
      session.report.note(fmt::format("  {:<20} {:<20} {:>11.7f} {:>10.1e}", scene.objects[i].name,
                                      scene.objects[j].name, factor, error));
    }
  }
  session.report.json()["view_factors"] = pairs;
}

void report_objects(const Scene& scene, const ViewFactorResult& result, Session& session) {
  nlohmann::json objects = nlohmann::json::array();
  for (std::size_t i = 0; i < result.objects; ++i) {
    objects.push_back({{"name", scene.objects[i].name},
                       {"area_m2", result.area[i]},
                       {"escaped", result.escaped[i]},
                       {"back_face", result.back_face[i]}});
  }
  session.report.json()["objects"] = objects;
}

void run(const Options& options, Session& session) {
  const Scene scene = import_and_report(options.scene, session);
  const RayScene rays(scene.mesh);
  const Stopwatch watch;
  const ViewFactorResult result =
      view_factors(scene.mesh, scene.objects.size(), rays, options.config, session.progress);
  session.progress.clear();
  session.report.section("run", "View factors");
  session.report.figure("rays", "rays per object", result.rays, grouped(result.rays));
  session.report.figure("seconds", "traced in", watch.seconds(), seconds_text(watch.seconds()));
  report_pairs(scene, result, session);
  report_objects(scene, result, session);
  if (!options.output.empty()) {
    write_file(options.output, csv(scene, result));
    session.report.figure("output", "wrote", options.output);
  }
}

}  // namespace

void add_viewfactors_command(CLI::App& app) {
  add_command<Options>(
      app, "viewfactors", "View factors between the named objects of a scene",
      "relumbre viewfactors satellite.glb --rays 1000000 -o factors.csv",
      [](CLI::App& command, Options& o) {
        add_scene_options(command, o.scene);
        command.add_option("--rays", o.config.rays, "Rays per object")->capture_default_str();
        command.add_option("--seed", o.config.seed, "Seed of the rays")->capture_default_str();
        command
            .add_option("--replicates", o.config.replicates,
                        "Randomisations that the errors come from")
            ->capture_default_str();
        command.add_option("-o,--output", o.output, "Also write the table as CSV");
      },
      run);
}

}  // namespace relumbre::cli
