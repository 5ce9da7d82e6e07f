// Inclusive scans of float32 from 2^10 to 2^28 elements: ours, oneTBB's, the standard library's
// with an execution policy, and OpenMP's simd scan, against memcpy with one and with two threads.
//
// This file is compiled for the machine it runs on, so that the peers have its widest vectors; ours
// are chosen at run time from the library. All run in this process, turn by turn; every time is a
// median. Every side sums the same positive numbers, and its last result is compared with the sum
// in long double.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <execution>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_scan.h>

#include "relumbre/base/huge_array.h"
#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan.h"
#include "report.h"

namespace {

using namespace relumbre;
using Input = std::span<const float>;
using Output = std::span<float>;

constexpr std::size_t kTurns = 7;
constexpr double kTurnSeconds = 0.03, kBatchSeconds = 30e-6;
constexpr std::size_t kPage = 4096 / sizeof(float);
/// Idle threads of the other side's pool spin for a while after their last work.
constexpr auto kSettle = std::chrono::milliseconds(30);

void ours(Input in, Output out) { inclusive_scan(in, out); }

void peer_tbb(Input in, Output out) {
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_scan(
      Range(0, in.size()), 0.0F,
      [&](const Range& range, float sum, bool is_final) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          sum += in[i];
          if (is_final) out[i] = sum;
        }
        return sum;
      },
      std::plus<>());
}

void peer_std(Input in, Output out) {
  std::inclusive_scan(std::execution::par, in.begin(), in.end(), out.begin());
}

[[gnu::noinline]] void peer_omp(Input in, Output out) {
  const float* from = in.data();
  float* to = out.data();
  float sum = 0;
#pragma omp simd reduction(inscan, + : sum)
  for (std::size_t i = 0; i < in.size(); ++i) {
    sum += from[i];
#pragma omp scan inclusive(sum)
    to[i] = sum;
  }
}

void copy_one(Input in, Output out) { std::memcpy(out.data(), in.data(), in.size_bytes()); }

void copy_two(Input in, Output out) {
  parallel_chunks(0, in.size(), (in.size() + 1) / 2, [&](std::size_t first, std::size_t last) {
    std::memcpy(&out[first], &in[first], (last - first) * sizeof(float));
  });
}

struct Side {
  std::string name;
  void (*run)(Input, Output);
  bool is_peer;
};
const Side kSides[] = {{"ours", ours, false},
                       {"tbb::parallel_scan", peer_tbb, true},
                       {"std::inclusive_scan(par)", peer_std, true},
                       {"omp simd inscan", peer_omp, true},
                       {"memcpy, 1 thread", copy_one, false},
                       {"memcpy, 2 threads", copy_two, false}};
constexpr std::size_t kSideCount = std::size(kSides), kFirstPeer = 1, kLastPeer = 3, kOneCopy = 4,
                      kTwoCopies = 5;

/// Seconds of one call, from a batch of calls too long for the clock's grain to matter.
double seconds_of_call(const Side& side, Input in, Output out, std::size_t batch) {
  const double seconds = bench::seconds_of([&] {
    for (std::size_t b = 0; b < batch; ++b) side.run(in, out);
  });
  return seconds / static_cast<double>(batch);
}

/// Median seconds of each side's calls on n elements, by turns. Every turn takes another part of
/// the arrays: on a shared machine some pages are nearer than others.
std::vector<double> time_in_turn(Input all_in, Output all_out, std::size_t n) {
  std::vector<std::vector<double>> turns(kSideCount);
  for (std::size_t turn = 0; turn < kTurns; ++turn) {
    const std::size_t from = (all_in.size() - n) / kTurns * turn / kPage * kPage;
    const Input in = all_in.subspan(from, n);
    const Output out = all_out.subspan(from, n);
    for (std::size_t s = 0; s < kSideCount; ++s) {
      std::this_thread::sleep_for(kSettle);
      const double first = seconds_of_call(kSides[s], in, out, 1);  // brings back caches, threads
      const auto batch = static_cast<std::size_t>(std::max(1.0, kBatchSeconds / first));
      std::vector<double> calls;
      for (double spent = 0; spent < kTurnSeconds || calls.size() < 3;) {
        calls.push_back(seconds_of_call(kSides[s], in, out, batch));
        spent += calls.back() * static_cast<double>(batch);
      }
      turns[s].push_back(bench::median(calls));
    }
  }
  std::vector<double> medians;
  for (const auto& side : turns) medians.push_back(bench::median(side));
  return medians;
}

struct Size {
  int log2;
  std::vector<double> seconds;
  [[nodiscard]] std::size_t best_peer() const {
    const auto first = seconds.begin();
    return static_cast<std::size_t>(std::min_element(first + kFirstPeer, first + kLastPeer + 1) -
                                    first);
  }
  [[nodiscard]] double speedup() const { return seconds[best_peer()] / seconds[0]; }
};

void report_size(const Size& size, bench::Report& report) {
  const std::string name = fmt::format("2^{}", size.log2);
  const std::size_t best = size.best_peer();
  report.add({name, 1e3 * size.seconds[0], kSides[best].name, 1e3 * size.seconds[best],
              kSides[kTwoCopies].name, 1e3 * size.seconds[kTwoCopies]});
  for (std::size_t s = kFirstPeer; s <= kOneCopy; ++s) {
    report.figure(fmt::format("{}: ours / {}, speed", name, kSides[s].name),
                  size.seconds[s] / size.seconds[0], "x");
  }
}

/// The last result of a scan of ones, which is the number of them.
void run_precision(Input ones, Output out, bench::Report& report) {
  const auto size = static_cast<double>(ones.size());
  report.note("\nlast result of a scan of as many ones, relative error");
  for (std::size_t s = 0; s <= kLastPeer; ++s) {
    kSides[s].run(ones, out);
    report.figure(fmt::format("error of {}", kSides[s].name),
                  std::abs(static_cast<double>(out.back()) - size) / size, "");
  }
}

int run(int argc, char** argv) {
  bench::Report report("scan", argc, argv);
  const int largest = std::stoi(report.option("log2", "28"));
  const int step = std::stoi(report.option("step", "2"));
  HugeArray<float> input(std::size_t{1} << largest), output(std::size_t{1} << largest);
  const Output in = input.span(), out = output.span();
  for (std::size_t i = 0; i < in.size(); ++i) in[i] = 1.0F / static_cast<float>(1 + i % 7);
  std::ranges::fill(out, 0.0F);

  report.heading("inclusive scan of float32 (limit: memcpy of as many, 2 threads)");
  double least = 1e9, least_in_cache = 1e9;
  for (int log2 = 10; log2 <= largest; log2 += step) {
    const std::size_t n = std::size_t{1} << log2;
    const Size size{log2, time_in_turn(in, out, n)};
    report_size(size, report);
    least = std::min(least, size.speedup());
    if (log2 >= 16 && log2 <= 20) least_in_cache = std::min(least_in_cache, size.speedup());
  }
  report.figure("speed against the best peer, least of all sizes", least, "x");
  report.figure("speed against the best peer, least of 2^16 to 2^20", least_in_cache, "x");
  std::ranges::fill(in, 1.0F);
  run_precision(in, out, report);
  return report.finish();
}

}  // namespace

int main(int argc, char** argv) { return bench::run_benchmark(run, argc, argv); }
