// The simulated machine: how fast caches are simulated from a stored trace, and what recording one
// costs beside the traversal alone.
//
// 1280 x 720 primary rays of the bunny by the geometry unit. The peer of the pass over all four L
// at once is a pass for each, any kind of cache: what the tests hold it against.
#include <array>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "packed_scene.h"
#include "relumbre/archsim/node_reads.h"
#include "relumbre/archsim/simulate.h"
#include "relumbre/archsim/trace_file.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/experiment/machine_trace.h"
#include "relumbre/experiment/word_scene.h"
#include "relumbre/octree/geometry_unit.h"
#include "relumbre/render/grid_rays.h"
#include "report.h"
#include "voxel_scene.h"

namespace relumbre::bench {
namespace {

constexpr std::uint32_t kWidth = 1280, kHeight = 720;
constexpr std::array<std::uint64_t, 4> kLines{512, 4096, 32'768, 262'144};

/// The rays of machine_trace() and nothing else. Returns how many hit.
std::size_t cast_alone(const WordScene& scene, const Camera& camera) {
  const GridRays rays(scene.cube, static_cast<unsigned>(scene.octree.depth()), camera, kWidth,
                      kHeight);
  std::vector<std::size_t> hits(kHeight);
  parallel_for(0, kHeight, 1, [&](std::size_t y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const CastRay ray = rays.through_center(x, y);
      hits[y] += trace_geometry_unit(scene.octree, ray.origin, ray.direction).has_value();
    }
  });
  return std::accumulate(hits.begin(), hits.end(), std::size_t{0});
}

std::vector<Simulation> pass_for_each(const Trace& trace, MachineConfig config) {
  std::vector<Simulation> all;
  for (const std::uint64_t lines : kLines) {
    config.lines = lines;
    all.push_back(simulate(trace, config));
  }
  return all;
}

/// A pass over the trace that was read back, on one core, against a pass for each L.
void simulate_stored(Report& report, const std::string& label, const Trace& trace) {
  const ThreadLimit one_core(1);
  const auto reads_m = static_cast<double>(trace.reads().size()) * 1e-6;
  for (const std::uint32_t tile : {2U, 20U}) {
    const MachineConfig config{.tile = tile};
    const std::vector<std::function<void()>> runs = {
        [&] { (void)simulate_lines(trace, config, kLines); },
        [&] { (void)pass_for_each(trace, config); }};
    const std::vector<double> seconds = median_seconds(runs, 3);
    const std::string name = fmt::format("{}, tile {}", label, tile);
    report.add({name, 1e3 * seconds[0], "a pass for each L", 1e3 * seconds[1], {}, kNotMeasured});
    report.figure(name + ": all four L at once", reads_m / seconds[0], "Mread/s and core");
    report.figure(name + ": a pass for each L", reads_m / seconds[1], "Mread/s and core");
    if (simulate_lines(trace, config, kLines) != pass_for_each(trace, config))
      throw std::runtime_error("the two do not agree");
  }
}

/// What the definition's factors do to M, the words fetched.
void tabulate_fetches(Report& report, const std::string& label, const Trace& trace) {
  for (const std::uint32_t tile : {2U, 10U, 20U, 40U}) {
    const auto all = simulate_lines(trace, {.tile = tile}, kLines);
    for (std::size_t i = 0; i < kLines.size(); ++i)
      report.figure(fmt::format("{}, tile {}, L {}: M", label, tile, kLines[i]),
                    static_cast<double>(metrics_of(all[i].total).proposed.fetches), "words");
  }
}

void measure(Report& report, const Scene& scene, unsigned depth) {
  const std::string label = fmt::format("bunny, depth {}", depth);
  report.heading(label);
  const WordScene words = word_scene(scene.mesh, depth, Separating::k26);
  const Camera camera = near_camera(scene);
  std::optional<Trace> trace;
  std::size_t hits = 0;
  const auto record = [&] {
    trace.emplace(machine_trace(words.octree, words.cube, camera, {kWidth, kHeight}));
  };
  const std::vector<std::function<void()>> runs = {
      [&] { hits = cast_alone(words, camera); }, record,
      [&] { record(), (void)simulate_lines(*trace, {.gts = 2}, kLines); }};
  const std::vector<double> seconds = median_seconds(runs, 3);
  report.figure(label + ": rays that hit", static_cast<double>(hits), "");
  report.figure(label + ": rays cast alone", 1e3 * seconds[0], "ms");
  report.figure(label + ": recorded / cast alone", seconds[1] / seconds[0], "");
  report.figure(label + ": recorded and simulated, 2 units / cast alone", seconds[2] / seconds[0],
                "");
  report.figure(label + ": reads", static_cast<double>(trace->reads().size()), "");
  report.figure(label + ": memory of the trace", static_cast<double>(trace->bytes()) * 1e-6, "MB");

  const TemporaryFolder folder;
  const auto file = folder / "bunny.rlt";
  report.figure(label + ": write the trace", 1e3 * seconds_of([&] { write_trace(file, *trace); }),
                "ms");
  report.figure(label + ": its file", static_cast<double>(std::filesystem::file_size(file)) * 1e-6,
                "MB");
  {
    const ThreadLimit one_core(1);
    const double read = seconds_of([&] { trace.emplace(read_trace(file)); });
    const double replayed = seconds_of([&] { (void)simulate_lines(*trace, {}, kLines); });
    report.figure(label + ": read it back", 1e3 * read, "ms, one core");
    report.figure(label + ": read back and all four L at once",
                  static_cast<double>(trace->reads().size()) * 1e-6 / (read + replayed),
                  "Mread/s and core");
  }
  simulate_stored(report, label, *trace);
  tabulate_fetches(report, label, *trace);
  report.figure(label + ": reads of each node counted",
                1e3 * seconds_of([&] { (void)count_node_reads(*trace); }), "ms");
}

int run(int argc, char** argv) {
  Report report("simulate", argc, argv);
  const auto bunny = read_packed_scene("stanford/bun_zipper.ply");
  if (!bunny) {
    report.note("skipped: RELUMBRE_DATA has no stanford/bun_zipper.ply.xz");
    return report.finish();
  }
  for (const unsigned depth : {8U, 10U}) measure(report, *bunny, depth);
  return report.finish();
}

}  // namespace
}  // namespace relumbre::bench

int main(int argc, char** argv) {
  return relumbre::bench::run_benchmark(relumbre::bench::run, argc, argv);
}
