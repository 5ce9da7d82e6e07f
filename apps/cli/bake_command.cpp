#include "cli/energy.h"
#include "cli/processor.h"
#include "cli/scene_input.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/store/bake.h"

namespace relumbre::cli {

namespace {

struct Options {
  SceneOptions scene;
  BakeConfig bake;
  std::string method = "cluster";
  std::string output, device;
};

void report_estimate(const BakeEstimate& estimate, Session& session) {
  Report& report = session.report;
  report.section("estimate", "Before it starts");
  report.figure("peak_bytes", "memory, at most", estimate.peak_bytes(),
                bytes_text(estimate.peak_bytes()));
  report.figure("disk_bytes", "disk, at most", estimate.disk_bytes,
                bytes_text(estimate.disk_bytes));
}

void report_bake(const BakeResult& result, double seconds, Session& session) {
  Report& report = session.report;
  const auto traced =
      static_cast<double>((result.settings.elements - result.resumed_rows) * result.settings.rays);
  report.figure("elements", "elements n", result.settings.elements,
                grouped(result.settings.elements));
  report.figure("patches", "patches k", result.settings.patches, grouped(result.settings.patches));
  report.figure("rays", "rays per element", result.settings.rays);
  report.figure("resumed_rows", "rows taken over", result.resumed_rows,
                grouped(result.resumed_rows));
  report.figure("nonzeros", "counts", result.nonzeros, grouped(result.nonzeros));
  report.figure("file_bytes", "store", result.file_bytes, bytes_text(result.file_bytes));
  report.figure("trace_s", "traced in", result.trace_seconds,
                fmt::format("{} ({:.2f} Mray/s)", seconds_text(result.trace_seconds),
                            traced / std::max(result.trace_seconds, 1e-9) / 1e6));
  report.figure("seconds", "baked in", seconds, seconds_text(seconds));
}

/// Runs the bake; a Ctrl-C says how to go on.
BakeResult bake_or_explain(const Scene& scene, const BakeConfig& config, const std::string& output,
                           Session& session) {
  try {
    return bake(scene, config, output, session.progress);
  } catch (const Cancelled&) {
    session.progress.clear();
    throw Cancelled(
        "interrupted; finished rows are kept: run the same command with --resume to go on");
  }
}

void run(const Options& options, Session& session) {
  BakeConfig config = options.bake;
  config.method = options.method == "hierarchy" ? PatchMethod::kHierarchy : PatchMethod::kCluster;
  config.scene_name = options.scene.file;
  config.tracer = make_processor(options.device, session)->form_factor_tracer();
  const AtomicFile writable(options.output);  // an unwritable folder is found out before the work
  const Scene scene = import_and_report(options.scene, session);
  report_estimate(estimate_bake(scene, config), session);

  const Stopwatch watch;
  const BakeResult result = bake_or_explain(scene, config, options.output, session);
  session.progress.clear();
  session.report.section("bake", options.output);
  report_bake(result, watch.seconds(), session);
  session.report.section("energy", "Energy");
  report_energy(result.energy, session);
}

}  // namespace

void add_bake_command(CLI::App& app) {
  add_command<Options>(
      app, "bake", "Trace a scene's form factors, once, into a store",
      "relumbre bake room.glb -o room.h5 --patches 1000 --elements 20000 --rays 512",
      [](CLI::App& command, Options& o) {
        add_scene_options(command, o.scene);
        command.add_option("-o,--output", o.output, "The store to write (.h5)")->required();
        command.add_option("--patches", o.bake.patches, "Patches k")->capture_default_str();
        command.add_option("--elements", o.bake.elements, "Elements n ≥ k")->capture_default_str();
        command.add_option("--rays", o.bake.rays, "Rays per element; powers of two are best")
            ->capture_default_str();
        command.add_option("--seed", o.bake.seed, "Seed of the rays")->capture_default_str();
        command
            .add_option("--method", o.method,
                        "cluster: any k ≤ n; hierarchy: the paper's 4-way cuts")
            ->check(CLI::IsMember({"cluster", "hierarchy"}))
            ->capture_default_str();
        add_device_option(command, o.device);
        command.add_flag("--resume", o.bake.resume, "Go on with an interrupted bake");
      },
      run);
}

}  // namespace relumbre::cli
