#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>

#include "cli/picture_options.h"
#include "cli/scene_input.h"
#include "cli/traversal_options.h"
#include "cli/view_options.h"
#include "relumbre/archsim/dinero.h"
#include "relumbre/archsim/simulate.h"
#include "relumbre/archsim/tiles.h"
#include "relumbre/archsim/trace_file.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/experiment/machine_trace.h"
#include "relumbre/experiment/word_scene.h"
#include "relumbre/image/heat_map.h"
#include "relumbre/image/image_io.h"
#include "relumbre/octree/rlo_file.h"
#include "relumbre/render/view_tiles.h"
#include "relumbre/render/voxel_view.h"

namespace relumbre::cli {

namespace {

struct Options {
  SceneOptions scene;  ///< or an octree, or a trace
  std::optional<unsigned> depth;
  int separating = 26;
  std::string camera = "auto";
  std::string size = "640x480";
  TraversalOptions traversal;
  MachineConfig machine;
  std::string replacement = "lru";
  std::string trace, heat_map;
  std::uint32_t trace_unit = 0;
  std::optional<int> trace_level;
  const CLI::App* command = nullptr;

  [[nodiscard]] bool is_given(const std::string& name) const { return command->count(name) > 0; }
};

constexpr unsigned kDepth = 8;

const std::map<std::string, Replacement> kReplacements{
    {"lru", Replacement::kLru}, {"fifo", Replacement::kFifo}, {"random", Replacement::kRandom}};

std::string extension(const std::string& file) {
  return std::filesystem::path(file).extension().string();
}

// --- what is simulated -----------------------------------------------------------------------

/// Options that say what the input has already said.
void refuse_given(const Options& options, std::initializer_list<const char*> names,
                  const std::string& reason) {
  for (const char* name : names)
    if (options.is_given(name))
      throw ValueError(options.scene.file + reason + ": not with " + name);
}

WordScene read_scene(const Options& options, Session& session) {
  if (extension(options.scene.file) != ".rlo") {
    const Scene scene = import_and_report(options.scene, session);
    const auto separating = options.separating == 6 ? Separating::k6 : Separating::k26;
    return word_scene(scene.mesh, options.depth.value_or(kDepth), separating, session.progress);
  }
  refuse_given(options, {"--depth", "--separating"}, " is made of voxels already");
  return word_scene(read_rlo(options.scene.file).tree);
}

Trace cast_rays(const Options& options, Session& session) {
  std::size_t width = 0, height = 0;
  parse_size(options.size, width, height);
  check_picture_size(width, height);
  std::optional<Camera> given;
  if (options.camera != "auto") given = read_camera(options.camera);
  const WordScene scene = read_scene(options, session);
  const Camera camera = given ? *given : voxel_camera(scene.cube);
  const MachineTraceConfig config{
      static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height),
      published_traversal(options.traversal.name, options.traversal.stack_nodes)};
  session.report.section("octree", options.scene.file);
  session.report.figure("depth", "depth", scene.octree.depth());
  session.report.figure("words", "words of 16 bits", scene.octree.internal_nodes(),
                        grouped(scene.octree.internal_nodes()));
  const Stopwatch watch;
  Trace trace = machine_trace(scene.octree, scene.cube, camera, config, session.progress);
  session.progress.clear();
  session.report.figure("traversed_s", "traversed in", watch.seconds(),
                        seconds_text(watch.seconds()));
  return trace;
}

Trace read_or_cast(const Options& options, Session& session) {
  if (extension(options.scene.file) != ".rlt") return cast_rays(options, session);
  refuse_given(options, {"--depth", "--separating", "--size", "--camera", "--traversal", "--stack"},
               " is a trace");
  return read_trace(options.scene.file);
}

// --- what it came to -------------------------------------------------------------------------

void report_system(const char* key, const char* title, const SystemMetrics& system,
                   const MachineMetrics& all, Session& session) {
  session.report.section(key, title);
  session.report.figure("fetches", "M, fetched from memory", system.fetches,
                        grouped(system.fetches));
  session.report.figure("bytes", "bytes", system.bytes, bytes_text(system.bytes));
  if (&system != &all.proposed) return;
  session.report.figure("hit_rate", "L, hits of reads", system.hit_rate,
                        fmt::format("{:.6f}", system.hit_rate));
}

nlohmann::json level_json(const CacheCounters& level, std::uint64_t lines) {
  return {{"lines", lines},
          {"reads", level.reads},
          {"hits", level.hits},
          {"misses", level.misses()},
          {"replacements", level.replacements},
          {"lines_used", level.lines_used}};
}

void report_levels(const UnitCounters& total, const MachineConfig& machine, Session& session) {
  const bool classes = !total.classes.empty();
  session.report.section("caches", "Caches, all units together");
  session.report.note(fmt::format("  {:>5} {:>9} {:>13} {:>13} {:>9} {:>13} {:>11}{}", "level",
                                  "lines", "reads", "hits", "hit rate", "replacements",
                                  "lines used",
                                  classes ? "   compulsory     capacity     conflict" : ""));
  nlohmann::json levels = nlohmann::json::array();
  for (std::size_t i = 0; i < total.levels.size(); ++i) {
    const CacheCounters& level = total.levels[i];
    const std::uint64_t lines = lines_of_level(static_cast<int>(i), machine.lines);
    nlohmann::json json = level_json(level, lines);
    std::string text =
        fmt::format("  {:>5} {:>9} {:>13} {:>13} {:>9.4f} {:>13} {:>11}", i, grouped(lines),
                    grouped(level.reads), grouped(level.hits), hit_rate(level),
                    grouped(level.replacements), grouped(level.lines_used));
    if (classes) {
      const MissClasses& c = total.classes[i];
      json["compulsory"] = c.compulsory, json["capacity"] = c.capacity,
      json["conflict"] = c.conflict;
      text += fmt::format(" {:>12} {:>12} {:>12}", grouped(c.compulsory), grouped(c.capacity),
                          grouped(c.conflict));
    }
    levels.push_back(std::move(json));
    session.report.note(text);
  }
  session.report.json()["levels"] = std::move(levels);
}

/// What was simulated, for those who read the JSON alone.
void report_machine(const Options& options, const Trace& trace, Session& session) {
  const MachineConfig& machine = options.machine;
  nlohmann::json json = {{"input", options.scene.file},
                         {"width", trace.shape().width},
                         {"height", trace.shape().height},
                         {"gts", machine.gts},
                         {"tile", machine.tile},
                         {"lines", machine.lines},
                         {"ways", machine.ways},
                         {"replacement", options.replacement},
                         {"seed", machine.seed}};
  if (extension(options.scene.file) != ".rlt") {
    const bool own = options.traversal.name.empty();
    json["traversal"] = own ? "machine" : options.traversal.name;
    if (options.traversal.name == "short-stack") json["stack"] = options.traversal.stack_nodes;
    json["camera"] = options.camera;
    if (extension(options.scene.file) != ".rlo") json["separating"] = options.separating;
  }
  session.report.json()["machine"] = std::move(json);
}

void report(const Trace& trace, const Simulation& simulation, const MachineConfig& machine,
            double seconds, Session& session) {
  const MachineMetrics metrics = metrics_of(simulation.total);
  session.report.section("picture", "Picture");
  session.report.figure("rays", "rays", simulation.total.rays, grouped(simulation.total.rays));
  session.report.figure("tasks", "tasks popped", metrics.tasks, grouped(metrics.tasks));
  session.report.figure("reads", "words asked for", metrics.reads, grouped(metrics.reads));
  session.report.figure("simulated_s", "simulated in", seconds,
                        fmt::format("{} ({:.1f} million reads/s)", seconds_text(seconds),
                                    static_cast<double>(trace.reads().size()) / seconds / 1e6));
  report_system("proposed", "Proposed machine", metrics.proposed, metrics, session);
  report_system("naive_word", "No caches, the same words", metrics.naive_word, metrics, session);
  report_system("naive_pointer", "No caches, records of 8 pointers", metrics.naive_pointer, metrics,
                session);
  report_levels(simulation.total, machine, session);
}

// --- files -----------------------------------------------------------------------------------

void check_outputs(const Options& options) {
  if (!options.trace.empty()) {
    const std::string kind = extension(options.trace);
    if (kind != ".rlt" && kind != ".din")
      throw FileError(options.trace, "cannot be written: traces are .rlt or .din");
    const AtomicFile writable(options.trace);
  }
  if (extension(options.trace) != ".din")
    for (const char* name : {"--trace-unit", "--trace-level"})
      if (options.is_given(name)) throw CLI::ValidationError(name, "is of a --trace FILE.din");
  if (options.trace_unit >= options.machine.gts)
    throw ValueError(fmt::format("--trace-unit {}: there are {} units, the first is 0",
                                 options.trace_unit, options.machine.gts));
  if (!options.heat_map.empty()) check_pictures({.outputs = {options.heat_map}}, "simulate");
}

/// Options that would have no say.
void check_options(const Options& options) {
  if (extension(options.scene.file) != ".rlt")
    check_traversal_options(*options.command, options.traversal);
  if (options.machine.ways == 1 && options.is_given("--replacement"))
    throw CLI::ValidationError("--replacement", "has no choice in caches of 1 way");
  if (options.is_given("--seed") && options.replacement != "random")
    throw CLI::ValidationError("--seed", "is of --replacement random");
}

/// A machine that cannot be built is refused before rays are cast.
void check_machine(const MachineConfig& machine) {
  const MemoryHierarchy smallest({.levels = static_cast<int>(kUpperLines.size()) + 1,
                                  .lines = machine.lines,
                                  .ways = machine.ways});
}

/// Reads of each pixel.
Image heat_map(const Trace& trace) {
  const std::array<std::string, 5> names{"R", "G", "B", "reads", "tasks"};
  Image image(trace.shape().width, trace.shape().height, names);
  const auto as_float = [](std::uint32_t count) { return static_cast<float>(count); };
  std::ranges::transform(trace.read_counts(), image.channel("reads").begin(), as_float);
  std::ranges::transform(trace.tasks(), image.channel("tasks").begin(), as_float);
  paint_heat(image, "reads");
  return image;
}

void write_outputs(const Options& options, const Trace& trace, Session& session) {
  session.report.section("files", "Files");
  if (!options.trace.empty()) {
    if (extension(options.trace) == ".rlt")
      write_trace(options.trace, trace);
    else
      write_dinero(options.trace, trace,
                   {.gts = options.machine.gts,
                    .unit = options.trace_unit,
                    .tile = options.machine.tile,
                    .level = options.trace_level});
    session.report.figure("trace", "wrote", options.trace);
  }
  if (!options.heat_map.empty()) {
    save_image(options.heat_map, heat_map(trace),
               {.auto_exposure = false, .curve = ToneCurve::kSrgb});
    session.report.figure("heat_map", "wrote", options.heat_map);
  }
}

void run(Options options, Session& session) {
  check_outputs(options);
  check_options(options);
  options.machine.replacement = kReplacements.at(options.replacement);
  check_machine(options.machine);
  const Trace trace = read_or_cast(options, session);
  const Stopwatch watch;
  const Simulation simulation = simulate(trace, options.machine);
  report(trace, simulation, options.machine, watch.seconds(), session);
  report_machine(options, trace, session);
  if (!options.trace.empty() || !options.heat_map.empty()) write_outputs(options, trace, session);
}

void define_rays(CLI::App& command, Options& o) {
  add_scene_options(command, o.scene);
  command.get_option("scene")->description(
      "A mesh, an octree of `relumbre voxelize` (.rlo), or a trace (.rlt)");
  command.add_option("--depth", o.depth, "Of a mesh: 2^depth voxels a side (default: 8)")
      ->check(CLI::Range(1U, kMaxWordDepth));
  command
      .add_option("--separating", o.separating,
                  "Of a mesh: 26, every voxel that a triangle touches, or 6, thin")
      ->check(CLI::IsMember({6, 26}))
      ->capture_default_str();
  command.add_option("--camera", o.camera, "auto (all of the cube), or cam.json")
      ->capture_default_str();
  command.add_option("--size", o.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  add_traversal_options(command, o.traversal, "machine",
                        "machine (the default), or another to compare its traffic with: restart, "
                        "backtrack, full-stack or short-stack");
}

void define(CLI::App& command, Options& o) {
  o.command = &command;
  define_rays(command, o);
  command.add_option("--gts", o.machine.gts, "Geometry units")
      ->check(CLI::Range(1U, Tiles::kMaxUnits))
      ->capture_default_str();
  command.add_option("--tile", o.machine.tile, "Pixels a side of a tile")
      ->check(CLI::Range(1U, TraceShape::kMaxSide))
      ->capture_default_str();
  command.add_option("--lines", o.machine.lines, "Lines of the caches of levels 3 and deeper")
      ->check(CLI::Range(std::uint64_t{1}, CacheConfig::kMaxLines))
      ->capture_default_str();
  command.add_option("--ways", o.machine.ways, "1: direct-mapped; 0: fully associative")
      ->capture_default_str();
  command.add_option("--replacement", o.replacement, "lru, fifo or random")
      ->check(CLI::IsMember({"lru", "fifo", "random"}))
      ->capture_default_str();
  command.add_option("--seed", o.machine.seed, "Of random replacement")->capture_default_str();
  command.add_flag("--classify", o.machine.classify,
                   "Tell compulsory, capacity and conflict misses apart");
  command.add_option("--trace", o.trace,
                     "Also write all reads: .rlt (compressed), or .din (Dinero's text)");
  command.add_option("--trace-unit", o.trace_unit, "Whose reads a .din has, in its order")
      ->capture_default_str();
  command.add_option("--trace-level", o.trace_level, "Of the tree, that alone; otherwise all");
  command.add_option("--heat-map", o.heat_map, "Also draw reads per pixel: .png or .exr");
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  add_command<Options>(app, "simulate", "What a ray caster with caches asks of its memory",
                       "relumbre simulate bunny.ply --depth 8 --tile 20 --lines 4096 --size "
                       "640x480 --heat-map reads.png",
                       define, run);
}

}  // namespace relumbre::cli
