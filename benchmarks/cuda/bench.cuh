/// What the benchmarks of the GPU side share: times by events, limits measured in the same run, the
/// table, and the figures that tools/gpu-check collects.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "relumbre/cuda/device.h"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"

namespace relumbre::bench {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

using Work = std::function<void(const cuda::Stream&)>;

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

inline double geometric_mean(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += std::log(v);
  return std::exp(sum / static_cast<double>(values.size()));
}

/// Median seconds on the device of each of `candidates`, which are run by turns `rounds` times
/// after two rounds of warm-up, so that a drift of the machine meets all of them alike.
inline std::vector<double> median_seconds(std::span<const Work> candidates,
                                          const cuda::Stream& stream, std::size_t rounds = 31) {
  constexpr std::size_t kWarmUp = 2;
  std::vector<std::vector<double>> seconds(candidates.size());
  const cuda::Event begin, end;
  for (std::size_t round = 0; round < rounds + kWarmUp; ++round) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      begin.record(stream);
      candidates[i](stream);
      end.record(stream);
      const double t = cuda::Event::seconds_between(begin, end);
      if (round >= kWarmUp) seconds[i].push_back(t);
    }
  }
  std::vector<double> medians;
  for (auto& times : seconds) medians.push_back(median(std::move(times)));
  return medians;
}

/// A copy from device memory to device memory that reads `bytes` in all and writes as many: the
/// limit of what reads and writes so much.
class DeviceCopy {
 public:
  explicit DeviceCopy(std::size_t bytes)
      : from_(std::make_shared<Bytes>(bytes)), to_(std::make_shared<Bytes>(bytes)) {}
  void operator()(const cuda::Stream& stream) const {
    cuda::copy_on_device(from_->data(), to_->data(), from_->size(), stream);
  }

 private:
  using Bytes = cuda::DeviceArray<std::byte>;
  std::shared_ptr<Bytes> from_, to_;
};

/// One case: ours, a peer that does the same work, and the least time that the device could take.
struct Row {
  std::string name;
  double seconds = kNotMeasured;
  double bytes = kNotMeasured;  ///< read and written
  std::string peer;
  double peer_seconds = kNotMeasured;
  std::string limit;
  double limit_seconds = kNotMeasured;

  [[nodiscard]] double speed_of_peer() const { return peer_seconds / seconds; }
  [[nodiscard]] double fraction_of_limit() const { return limit_seconds / seconds; }
};

inline void print_heading(const char* text) {
  const cuda::DeviceInfo device = cuda::current_device();
  std::printf("%s, on %s (sm_%d%d, %d multiprocessors)\n", text, device.name.c_str(), device.major,
              device.minor, device.multiprocessors);
  std::printf("%-44s %10s %9s  %-26s %-26s\n", "case", "ms", "GB/s", "speed / peer's",
              "of the limit");
}

inline void print(const Row& row) {
  const auto ratio = [](double value, const std::string& to) {
    char text[64] = "";
    if (!to.empty()) std::snprintf(text, sizeof(text), "%.2f  %s", value, to.c_str());
    return std::string(text);
  };
  std::printf("%-44s %10.4f %9.1f  %-26s %-26s\n", row.name.c_str(), row.seconds * 1e3,
              row.bytes / row.seconds * 1e-9, ratio(row.speed_of_peer(), row.peer).c_str(),
              ratio(row.fraction_of_limit(), row.limit).c_str());
}

/// A figure that was asked for: a line for people and a last one for tools/gpu-check,
///   FIGURE <name> <value> <wanted> <unit>
/// `wanted` is the least value that is good enough, or the greatest where `less_is_better`.
inline void print_figure(const char* name, double value, double wanted, const char* unit,
                         bool less_is_better = false) {
  const bool reached = less_is_better ? value <= wanted : value >= wanted;
  std::printf("%s: %.4g %s, wanted %s %.4g: %s\n", name, value, unit,
              less_is_better ? "at most" : "at least", wanted, reached ? "reached" : "NOT reached");
  std::printf("FIGURE %s %.6g %.6g %s\n", name, value, wanted, unit);
}

/// What a benchmark's main returns: 0, or 1 and the reason on standard error; 0 and a word about it
/// where there is no device.
inline int run_benchmark(void (*run)()) {
  try {
    if (cuda::devices().empty()) {
      std::printf("no CUDA device: nothing measured\n");
      return 0;
    }
    run();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

}  // namespace relumbre::bench
