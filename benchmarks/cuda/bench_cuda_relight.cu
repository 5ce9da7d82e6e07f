// The real-time stage on a GPU: the fused pass against the memory's bandwidth, against the paper's
// stage by cuBLAS in its nine cases, and batches. Fields are random; times do not depend on them.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "bench.cuh"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/warp.cuh"
#include "relumbre/radiosity/relight_cuda.h"

namespace relumbre::bench {
namespace {

using cuda::DeviceRelight, cuda::PaperRelight, cuda::PaperStage;

/// Counts of 512 rays in 48 columns a row, and an exchange that is small enough.
struct Case {
  SparseCounts counts;
  std::vector<std::uint32_t> offsets;
  std::vector<float> weight;
  std::vector<Rgb> reflectance;
  std::vector<double> transport;  ///< of every channel

  Case(std::size_t n, std::size_t k) : reflectance(n), transport(k * k) {
    const std::size_t each = std::min<std::size_t>(48, k);
    counts.columns = k, counts.rays = 512;
    counts.column.resize(n * each), counts.count.resize(n * each);
    counts.row_offsets.resize(n + 1);
    parallel_for(0, n, 1024, [&](std::size_t i) {
      RandomStream random(i);
      for (std::size_t j = 0; j < each; ++j) {  // one in each of as many ranges: ascending
        const std::size_t first = j * k / each, last = (j + 1) * k / each;
        counts.column[i * each + j] =
            static_cast<std::uint32_t>(first + random.bits() % (last - first));
        counts.count[i * each + j] = 1 + static_cast<std::uint32_t>(random.bits() % 10);
      }
      counts.row_offsets[i + 1] = (i + 1) * each;
      reflectance[i] = {0.3F + 0.5F * random.uniform(), 0.5F, 0.4F};
    });
    for (std::size_t p = 0; p <= k; ++p) offsets.push_back(static_cast<std::uint32_t>(p * n / k));
    for (std::size_t p = 0; p < k; ++p)
      weight.insert(weight.end(), offsets[p + 1] - offsets[p],
                    1 / static_cast<float>(offsets[p + 1] - offsets[p]));
    parallel_for(0, k * k, 1 << 16, [&](std::size_t i) {
      transport[i] = static_cast<double>(to_unit(static_cast<std::uint32_t>(hash64(i)))) /
                     static_cast<double>(k);
    });
  }
  [[nodiscard]] cuda::RelightParts parts() const {
    return {counts, offsets, weight, reflectance, {transport, transport, transport}};
  }
};

constexpr unsigned kReadThreads = 512;

/// Reads everything once; the sum keeps the compiler honest.
__global__ void read_all(const uint4* from, std::size_t count, unsigned* sum) {
  unsigned mine = 0;
  const std::size_t stride = std::size_t{gridDim.x} * kReadThreads;
#pragma unroll 8
  for (std::size_t i = std::size_t{blockIdx.x} * kReadThreads + threadIdx.x; i < count;
       i += stride) {
    const uint4 v = __ldg(from + i);
    mine += v.x ^ v.y ^ v.z ^ v.w;
  }
  if (mine == 0x12345678U) *sum = mine;
}

/// Bytes a second, of an array far larger than the caches.
double read_bandwidth(const cuda::Stream& stream) {
  const std::size_t bytes =
      std::min<std::size_t>(std::size_t{4} << 30, cuda::current_device().free_bytes / 4);
  const cuda::DeviceArray<uint4> array(bytes / sizeof(uint4));
  const cuda::DeviceArray<unsigned> sum(1);
  cuda::clear(array.data(), array.size(), stream);
  const auto blocks = static_cast<unsigned>(cuda::resident_blocks(read_all, kReadThreads));
  const Work read = [&](const cuda::Stream& s) {
    cuda::launch(read_all, {.blocks = blocks, .threads = kReadThreads}, s, array.data(),
                 array.size(), sum.data());
  };
  return static_cast<double>(array.bytes()) / median_seconds({&read, 1}, stream)[0];
}

/// Median of the host's clock.
template <class Body>
double host_seconds(const Body& body, int rounds = 21) {
  std::vector<double> seconds;
  for (int i = 0; i < rounds + 2; ++i) {
    const auto start = std::chrono::steady_clock::now();
    body();
    const double t =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (i >= 2) seconds.push_back(t);
  }
  return median(seconds);
}

/// Largest difference of two operators on one random field, as a part of the largest value.
double disagreement(const RelightOperator& a, const RelightOperator& b) {
  std::vector<float> emission(3 * a.elements()), x(emission.size()), y(emission.size());
  RandomStream random(1);
  for (float& e : emission) e = random.uniform();
  a.apply(emission, x);
  b.apply(emission, y);
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = std::abs(static_cast<double>(x[i]) - static_cast<double>(y[i]));
    worst = off <= worst ? worst : off;
    largest = std::max(largest, static_cast<double>(std::abs(y[i])));
  }
  return worst / largest;
}

/// The fused pass over U and the whole stage against reading as many bytes.
void fused_pass(double bandwidth) {
  std::printf("\nfused relight of three channels, kernels alone; memory reads %.0f GB/s\n",
              bandwidth * 1e-9);
  std::printf("%-10s %10s %8s %12s %10s %10s\n", "format", "n", "k", "stage ms", "GB/s",
              "of limit");
  const Case scene(221'184, 3456);
  for (const CountFormat format :
       {CountFormat::kCounts8, CountFormat::kCounts16, CountFormat::kFloat16}) {
    const DeviceRelight op(scene.parts(), format);
    const double seconds = op.measure_kernels(50),
                 speed = static_cast<double>(op.bytes_per_apply()) / seconds;
    std::printf("%-10s %10zu %8zu %12.4f %10.0f %9.1f%%\n", to_string(format).data(), op.elements(),
                op.patches(), seconds * 1e3, speed * 1e-9, 100 * speed / bandwidth);
    if (format == CountFormat::kCounts8) {
      const double scatter = op.measure_scatter(50);
      std::printf("  of which the pass over U takes %.4f ms\n", scatter * 1e3);
      for (const std::size_t sources : {4, 8}) {
        const double batch = op.measure_kernels(20, sources);
        std::printf("  %zu sources in one pass: %.4f ms, %.2f times as fast as one by one\n",
                    sources, batch * 1e3, static_cast<double>(sources) * seconds / batch);
      }
      print_figure("relight_bandwidth_share", speed / bandwidth, 0.8, "of the read bandwidth");
    }
  }
}

struct Dimensions {
  std::size_t n, k;
};
constexpr Dimensions kPaperCases[] = {{3456, 216},    {3456, 864},   {13'824, 216},
                                      {3456, 3456},   {13'824, 864}, {55'296, 216},
                                      {13'824, 3456}, {55'296, 864}, {221'184, 216}};

/// The nine cases of the paper's table 3, copies of E and B included.
void paper_cases() {
  std::printf("\nthe paper's nine cases, copies included, ms\n");
  std::printf("%10s %6s %10s %10s %12s %12s %10s %9s %12s\n", "n", "k", "paper", "sparse V",
              "V'E on CPU", "rows on both", "fused", "paper/", "difference");
  std::vector<double> ratios;
  for (const auto& [n, k] : kPaperCases) {
    const Case scene(n, k);
    double times[4] = {};
    for (const PaperStage stage : cuda::kPaperStages) {
      const PaperRelight op(scene.parts(), stage);
      times[static_cast<std::size_t>(stage)] = host_seconds([&] { op.relight_channels(); });
    }
    const DeviceRelight fused(scene.parts(), CountFormat::kCounts8);
    std::fill(fused.emission().begin(), fused.emission().end(), 1.0F);
    const double ours = host_seconds([&] { fused.relight(); });
    const double off = disagreement(fused, PaperRelight(scene.parts(), PaperStage::kSparseV));
    ratios.push_back(times[0] / ours);
    std::printf("%10zu %6zu %10.4f %10.4f %12.4f %12.4f %10.4f %9.2f %12.1e\n", n, k,
                times[0] * 1e3, times[1] * 1e3, times[2] * 1e3, times[3] * 1e3, ours * 1e3,
                ratios.back(), off);
  }
  print_figure("relight_vs_cublas_geomean", geometric_mean(ratios), 10, "times as fast");
}

/// How the split of rows between both processors turns out, in the paper's largest case.
void splits() {
  std::printf("\nrows on both processors, n = 55,296, k = 864: ms by the CPU's share\n");
  const Case scene(55'296, 864);
  for (const double share : {0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5}) {
    const PaperRelight op(scene.parts(), PaperStage::kSplitRows, share);
    std::printf("  %4.0f%%  %.4f\n", 100 * share,
                host_seconds([&] { op.relight_channels(); }, 11) * 1e3);
  }
}

void million_elements() {
  const Case scene(1'000'000, 4096);
  const DeviceRelight op(scene.parts(), CountFormat::kCounts8);
  std::fill(op.emission().begin(), op.emission().end(), 1.0F);
  const double kernels = op.measure_kernels(20), whole = host_seconds([&] { op.relight(); });
  std::printf("\nn = 1,000,000, k = 4,096: %.3f ms, with copies of E and B %.3f ms\n",
              kernels * 1e3, whole * 1e3);
  print_figure("relight_million_ms", kernels * 1e3, 2, "ms", true);
}

void run() {
  const cuda::Stream stream;
  const cuda::DeviceInfo device = cuda::current_device();
  std::printf("relight, on %s (sm_%d%d, %d multiprocessors)\n", device.name.c_str(), device.major,
              device.minor, device.multiprocessors);
  fused_pass(read_bandwidth(stream));
  paper_cases();
  splits();
  if (device.free_bytes > (std::size_t{8} << 30)) million_elements();
}

}  // namespace
}  // namespace relumbre::bench

int main() { return relumbre::bench::run_benchmark(relumbre::bench::run); }
