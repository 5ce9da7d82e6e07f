// The real-time stage against the paper's own, on the nine cases of its table, side by side.
//
// Counts are those of the Cornell box, cut as in the paper, with 512 rays an element. Both stages
// run in this process, turn by turn; every time is a median. The limit is a loop that reads as
// many bytes as our stage touches, run by turns with it too: what fits the caches is read from
// them, and a drift of the machine meets both.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/huge_array.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/radiosity/form_factors.h"
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

/// Reads `bytes` of memory with all threads and does nothing else: what the machine can do at most
/// for a stage that touches as many, wherever in its caches and memory so many bytes end up.
class ReadLoop {
 public:
  explicit ReadLoop(std::size_t bytes)
      : memory_(bytes),
        values_(reinterpret_cast<std::uint64_t*>(memory_.data()), bytes / sizeof(std::uint64_t)),
        sums_(values_.size() / kGrain + 1) {
    std::ranges::fill(values_, 1);
  }
  [[nodiscard]] std::function<void()> call() {
    return [this] { read(); };
  }

 private:
  static constexpr std::size_t kGrain = std::size_t{1} << 14;

  void read() {
    parallel_chunks(0, values_.size(), kGrain, [&](std::size_t first, std::size_t last) {
      sums_[first / kGrain] = sum_of(&values_[first], last - first);
    });
    if (std::accumulate(sums_.begin(), sums_.end(), std::uint64_t{0}) != values_.size())
      throw std::logic_error("the sum of ones is not their number");
  }

  HugeBuffer memory_;
  std::span<std::uint64_t> values_;
  std::vector<std::uint64_t> sums_;
};

/// GB/s of main memory: of 1 GiB, the best of several passes.
double read_bandwidth() {
  constexpr std::size_t bytes = std::size_t{1} << 30;
  ReadLoop loop(bytes);
  std::vector<double> seconds;
  for (int pass = 0; pass < 12; ++pass) seconds.push_back(seconds_of(loop.call()));
  return static_cast<double>(bytes) / *std::ranges::min_element(seconds) / 1e9;
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
  /// What one call reads and writes.
  [[nodiscard]] std::size_t bytes() const { return operator_->bytes_per_apply(); }
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

void run_cases(bench::Report& report) {
  report.heading("the paper's nine cases, 8-bit counts");
  std::vector<double> all, large;
  double difference = 0;
  for (const PaperCase& size : kCases) {
    const Baked baked = bake_cornell(size);
    Stage ours(make_compressed_operator(baked.input(), CountFormat::kCounts8));
    Stage peer(make_paper_operator(baked.input()));
    ReadLoop limit(ours.bytes());
    const std::vector<double> times = time_in_turn({ours.call(), peer.call(), limit.call()});
    const bench::Row row{size.name(), times[0],          "paper, 6 OpenBLAS sgemv",
                         times[1],    "reading as much", times[2]};
    report.add(row);
    all.push_back(row.speedup_vs_peer());
    if (size.large) large.push_back(row.speedup_vs_peer());
    difference = std::max(difference, ours.difference(peer));
  }
  report.figure("speed-up, geometric mean of cases 5, 6, 8, 9", bench::geometric_mean(large), "x");
  report.figure("speed-up, geometric mean of all nine", bench::geometric_mean(all), "x");
  report.figure("largest difference from the peer, of max B", difference, "");
}

void run_formats(bench::Report& report) {
  report.heading("formats of U, " + kCase8.name());
  const Baked baked = bake_cornell(kCase8);
  std::vector<std::unique_ptr<Stage>> stages;
  std::vector<std::unique_ptr<ReadLoop>> limits;
  std::vector<std::function<void()>> calls;
  for (const CountFormat format : {CountFormat::kFloat32, CountFormat::kFloat16,
                                   CountFormat::kCounts16, CountFormat::kCounts8}) {
    stages.push_back(std::make_unique<Stage>(make_compressed_operator(baked.input(), format)));
    limits.push_back(std::make_unique<ReadLoop>(stages.back()->bytes()));
    calls.push_back(stages.back()->call());
    calls.push_back(limits.back()->call());
  }
  const std::vector<double> times = time_in_turn(calls);
  for (std::size_t s = 0; s < stages.size(); ++s)
    report.add({stages[s]->name(), times[2 * s], "float32", times[0], "reading as much",
                times[2 * s + 1]});
  for (const auto& stage : stages)
    report.figure(fmt::format("difference of {} from float32, of max B", stage->name()),
                  stage->difference(*stages[0]), "");
}

void run_batches(bench::Report& report) {
  for (const PaperCase& size : {kCase5, kCase8}) {
    report.heading("sources at a time, 8-bit counts, " + size.name());
    const Baked baked = bake_cornell(size);
    const auto stage = [&](std::size_t sources) {
      return std::make_unique<Stage>(make_compressed_operator(baked.input(), CountFormat::kCounts8),
                                     sources);
    };
    const auto one = stage(1), few = stage(8), many = stage(64);
    const std::vector<double> times = time_in_turn({one->call(), few->call(), many->call()});
    const auto add = [&](double sources, double time) {
      report.add({fmt::format("{} sources", sources), time, "one at a time", sources * times[0], "",
                  bench::kNotMeasured});
    };
    add(1, times[0]), add(8, times[1]), add(64, times[2]);
  }
}

int run(int argc, char** argv) {
  bench::Report report("relight", argc, argv);
  report.figure("threads", static_cast<double>(thread_count()), "");
  report.figure("read bandwidth of main memory", read_bandwidth(), "GB/s");
  run_cases(report);
  run_formats(report);
  run_batches(report);
  return report.finish();
}

}  // namespace

int main(int argc, char** argv) { return bench::run_benchmark(run, argc, argv); }
