#include "report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "relumbre/base/atomic_file.h"

namespace relumbre::bench {

namespace {

std::string processor_model() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

std::string cell(double value, std::string_view format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

}  // namespace

Report::Report(std::string name, int argc, char** argv)
    : name_(std::move(name)), arguments_(argv + 1, argv + argc) {
  output_ = option("output", "");
  const nlohmann::json machine = describe_machine();
  fmt::print("{}: {}, {} cores\n", name_, machine["processor"].get<std::string>(),
             machine["cores"].get<unsigned>());
}

std::string Report::option(std::string_view name, std::string otherwise) const {
  const std::string flag = "--" + std::string(name);
  const auto at = std::find(arguments_.begin(), arguments_.end(), flag);
  return at == arguments_.end() || at + 1 == arguments_.end() ? otherwise : *(at + 1);
}

void Report::heading(std::string_view text) {
  fmt::print("\n{}\n{:<34} {:>10} {:<26} {:>10} {:<18} {:>10} {:>8} {:>7}\n", text, "case",
             "ours ms", "peer", "peer ms", "limit", "limit ms", "vs peer", "of lim");
}

void Report::add(const Row& row) {
  fmt::print("{:<34} {:>10} {:<26} {:>10} {:<18} {:>10} {:>8} {:>7}\n", row.name,
             cell(row.ours_ms, "{:.3f}"), row.peer, cell(row.peer_ms, "{:.3f}"), row.limit,
             cell(row.limit_ms, "{:.3f}"), cell(row.speedup_vs_peer(), "{:.2f}x"),
             cell(row.fraction_of_limit() * 100, "{:.0f}%"));
  std::fflush(stdout);
  rows_.push_back(row);
}

void Report::figure(const std::string& key, double value, std::string_view unit) {
  fmt::print("{:<60} {:.4g} {}\n", key, value, unit);
  std::fflush(stdout);
  figures_[key] = {{"value", number(value)}, {"unit", unit}};
}

void Report::note(std::string_view text) {
  fmt::print("{}\n", text);
  std::fflush(stdout);
}

int Report::finish() {
  if (output_.empty()) return 0;
  nlohmann::json json = {
      {"benchmark", name_}, {"machine", describe_machine()}, {"figures", figures_}};
  json["rows"] = nlohmann::json::array();
  for (const Row& row : rows_) {
    json["rows"].push_back({{"case", row.name},
                            {"ours_ms", number(row.ours_ms)},
                            {"peer", row.peer},
                            {"peer_ms", number(row.peer_ms)},
                            {"limit", row.limit},
                            {"limit_ms", number(row.limit_ms)},
                            {"speedup_vs_peer", number(row.speedup_vs_peer())},
                            {"fraction_of_limit", number(row.fraction_of_limit())}});
  }
  write_file(output_, json.dump(2) + "\n");
  fmt::print("\nwrote {}\n", output_);
  return 0;
}

int run_benchmark(int (*run)(int argc, char** argv), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

std::vector<double> median_seconds(std::span<const std::function<void()>> candidates,
                                   std::size_t rounds) {
  std::vector<std::vector<double>> seconds(candidates.size());
  for (std::size_t round = 0; round <= rounds; ++round) {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const double elapsed = seconds_of(candidates[c]);
      if (round > 0) seconds[c].push_back(elapsed);
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& s : seconds) medians.push_back(median(std::move(s)));
  return medians;
}

double seconds_of(const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double geometric_mean(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += std::log(v);
  return std::exp(sum / static_cast<double>(values.size()));
}

nlohmann::json describe_machine() {
  const auto pages = static_cast<double>(sysconf(_SC_PHYS_PAGES));
  const auto page = static_cast<double>(sysconf(_SC_PAGE_SIZE));
  return {{"processor", processor_model()},
          {"cores", std::thread::hardware_concurrency()},
          {"memory_gib", std::round(pages * page / (1 << 30))},
          {"compiler", __VERSION__}};
}

}  // namespace relumbre::bench
