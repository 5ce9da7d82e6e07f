// The real-time stage against the paper's own, on the nine cases of its table, side by side.
//
// Counts are those of the Cornell box, cut as in the paper, with 512 rays an element. Both stages
// run in this process, turn by turn; every time is a median. The limit is the time that this
// machine's memory needs for the bytes our stage touches; a case that fits the caches beats it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/radiosity/huge_buffer.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/element_materials.h"
#include "report.h"

namespace {

using namespace relumbre;

constexpr std::uint32_t kRays = 512;
constexpr std::size_t kTurns = 7;
constexpr double kTurnSeconds = 0.04;
/// Idle threads of the other side's pool spin for a while after their last work.
constexpr auto kSettle = std::chrono::milliseconds(60);

struct PaperCase {
  std::size_t elements, patches;
  bool large;  ///< where U outweighs M
  [[nodiscard]] std::string name() const { return fmt::format("n={} k={}", elements, patches); }
};
constexpr PaperCase kCases[] = {{3456, 216, false},   {3456, 864, false}, {13824, 216, false},
                                {3456, 3456, false},  {13824, 864, true}, {55296, 216, true},
                                {13824, 3456, false}, {55296, 864, true}, {221184, 216, true}};
constexpr PaperCase kCase5 = kCases[4], kCase8 = kCases[7];

struct Baked {
  Tessellation tessellation;
  SparseCounts counts;
  std::vector<Rgb> reflectance;
  [[nodiscard]] OperatorInput input() const {
    return {counts, tessellation.patch_offsets, tessellation.area, reflectance};
  }
};

Baked bake_cornell(const PaperCase& size) {
  const Scene scene = make_cornell_scene();
  TessellationConfig config;
  config.elements = size.elements, config.patches = size.patches;
  config.method = PatchMethod::kHierarchy;
  Baked baked;
  baked.tessellation = tessellate(scene.mesh, config);
  FormFactorConfig rays;
  rays.rays = kRays;
  baked.counts =
      trace_form_factors(baked.tessellation, RayScene(scene.mesh), rays, Binning::kPatches).counts;
  baked.reflectance = element_materials(scene, baked.tessellation).reflectance;
  return baked;
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Runs each stage in turn, for a while each, and returns the median milliseconds of its calls.
std::vector<double> time_in_turn(const std::vector<std::function<void()>>& stages) {
  std::vector<std::vector<double>> times(stages.size());
  for (std::size_t turn = 0; turn < kTurns; ++turn) {
    for (std::size_t s = 0; s < stages.size(); ++s) {
      std::this_thread::sleep_for(kSettle);
      stages[s]();  // brings back caches and threads
      std::vector<double> calls;
      for (double spent = 0; spent < kTurnSeconds || calls.size() < 3; spent += calls.back())
        calls.push_back(seconds_of(stages[s]));
      times[s].push_back(bench::median(calls));
    }
  }
  std::vector<double> medians;
  for (const auto& stage : times) medians.push_back(1e3 * bench::median(stage));
  return medians;
}

/// Compiled for wide loads too, so that it is the memory that limits.
[[gnu::target_clones("avx512f", "avx2", "default")]] std::uint64_t sum_of(
    const std::uint64_t* values, std::size_t count) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += values[i];
  return sum;
}

/// Bytes a millisecond when all threads sum 1 GiB: the best of several passes.
double read_bandwidth() {
  constexpr std::size_t words = std::size_t{1} << 27, grain = std::size_t{1} << 17;
  HugeBuffer memory(words * sizeof(std::uint64_t));
  const std::span values(reinterpret_cast<std::uint64_t*>(memory.data()), words);
  std::ranges::fill(values, 1);
  std::vector<std::uint64_t> sums(words / grain);
  std::vector<double> seconds;
  for (int pass = 0; pass < 12; ++pass) {
    seconds.push_back(seconds_of([&] {
      parallel_chunks(0, words, grain, [&](std::size_t first, std::size_t last) {
        sums[first / grain] = sum_of(&values[first], last - first);
      });
    }));
  }
  if (std::accumulate(sums.begin(), sums.end(), std::uint64_t{0}) != words) return 0;
  return static_cast<double>(memory.size()) / *std::ranges::min_element(seconds) / 1e3;
}

/// An operator with fields to run it on.
class Stage {
 public:
  explicit Stage(std::unique_ptr<RelightOperator> op, std::size_t sources = 1)
      : operator_(std::move(op)),
        sources_(sources),
        emission_(3 * operator_->elements() * sources) {
    RandomStream random(1);
    for (float& e : emission_) e = random.uniform();
    radiosity_.resize(emission_.size());
  }
  [[nodiscard]] std::function<void()> call() {
    return [this] { operator_->apply(emission_, radiosity_, sources_); };
  }
  /// Milliseconds that memory needs for what one call touches.
  [[nodiscard]] double limit(double bandwidth) const {
    return static_cast<double>(operator_->bytes_per_apply()) / bandwidth;
  }
  [[nodiscard]] std::string name() const { return std::string(operator_->name()); }
  /// The largest difference of the radiosities, of the largest radiosity.
  [[nodiscard]] double difference(const Stage& other) const {
    float difference = 0, largest = 0;
    for (std::size_t i = 0; i < radiosity_.size(); ++i) {
      difference = std::max(difference, std::abs(radiosity_[i] - other.radiosity_[i]));
      largest = std::max(largest, std::abs(other.radiosity_[i]));
    }
    return static_cast<double>(difference / largest);
  }

 private:
  std::unique_ptr<RelightOperator> operator_;
  std::size_t sources_;
  std::vector<float> emission_, radiosity_;
};

void run_cases(bench::Report& report, double bandwidth) {
  report.heading("the paper's nine cases, 8-bit counts");
  std::vector<double> all, large;
  double difference = 0;
  for (const PaperCase& size : kCases) {
    const Baked baked = bake_cornell(size);
    Stage ours(make_compressed_operator(baked.input(), CountFormat::kCounts8));
    Stage peer(make_paper_operator(baked.input()));
    const std::vector<double> times = time_in_turn({ours.call(), peer.call()});
    const bench::Row row{size.name(), times[0],         "paper, 6 OpenBLAS sgemv",
                         times[1],    "read bandwidth", ours.limit(bandwidth)};
    report.add(row);
    all.push_back(row.speedup_vs_peer());
    if (size.large) large.push_back(row.speedup_vs_peer());
    difference = std::max(difference, ours.difference(peer));
  }
  report.figure("speed-up, geometric mean of cases 5, 6, 8, 9", bench::geometric_mean(large), "x");
  report.figure("speed-up, geometric mean of all nine", bench::geometric_mean(all), "x");
  report.figure("largest difference from the peer, of max B", difference, "");
}

void run_formats(bench::Report& report, double bandwidth) {
  report.heading("formats of U, " + kCase8.name());
  const Baked baked = bake_cornell(kCase8);
  std::vector<std::unique_ptr<Stage>> stages;
  std::vector<std::function<void()>> calls;
  for (const CountFormat format : {CountFormat::kFloat32, CountFormat::kFloat16,
                                   CountFormat::kCounts16, CountFormat::kCounts8}) {
    stages.push_back(std::make_unique<Stage>(make_compressed_operator(baked.input(), format)));
    calls.push_back(stages.back()->call());
  }
  const std::vector<double> times = time_in_turn(calls);
  for (std::size_t s = 0; s < stages.size(); ++s)
    report.add({stages[s]->name(), times[s], "float32", times[0], "read bandwidth",
                stages[s]->limit(bandwidth)});
  for (const auto& stage : stages)
    report.figure(fmt::format("difference of {} from float32, of max B", stage->name()),
                  stage->difference(*stages[0]), "");
}

void run_batches(bench::Report& report) {
  report.heading("sources at a time, 8-bit counts, " + kCase5.name());
  const Baked baked = bake_cornell(kCase5);
  double single = bench::kNotMeasured;
  for (const std::size_t sources : {1, 8, 64}) {
    Stage stage(make_compressed_operator(baked.input(), CountFormat::kCounts8), sources);
    const double time = time_in_turn({stage.call()}).front();
    if (sources == 1) single = time;
    report.add({fmt::format("{} sources", sources), time, "one at a time",
                single * static_cast<double>(sources), "", bench::kNotMeasured});
  }
}

}  // namespace

int main(int argc, char** argv) {
  bench::Report report("relight", argc, argv);
  const double bandwidth = read_bandwidth();
  report.figure("threads", static_cast<double>(thread_count()), "");
  report.figure("read bandwidth", bandwidth * 1e-6, "GB/s");
  run_cases(report, bandwidth);
  run_formats(report, bandwidth);
  run_batches(report);
  return report.finish();
}
