// Form factors on the device against the same rays through the same hierarchy on two CPU cores, and
// whether they count the same. The device's time is that of the whole of trace_form_factors:
// copying the hierarchy there, making and tracing rays, counting, and rows that come back. Building
// the hierarchy is told apart, as in bench bake, which also says how fast the CPU is with Embree.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "bench.cuh"
#include "relumbre/base/parallel.h"
#include "relumbre/cuda/device.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/radiosity/form_factor_rows.h"
#include "relumbre/radiosity/form_factors_cuda.h"
#include "relumbre/radiosity/scalar_form_factors.h"
#include "relumbre/visibility/bvh_tracer.h"
#include "relumbre/visibility/ray_scene_cuda.h"

namespace relumbre {
namespace {

constexpr std::uint32_t kRays = 512;
constexpr std::size_t kCpuCores = 2;  // the machine that the figure was asked for has two
constexpr std::size_t kCpuRows = 4096;
constexpr std::size_t kRounds = 5;

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median_seconds_of(const std::function<void()>& work) {
  std::vector<double> seconds;
  work();
  for (std::size_t i = 0; i < kRounds; ++i) seconds.push_back(seconds_of(work));
  return bench::median(seconds);
}

void add_quad(TriangleMesh& mesh, const Vec3f& corner, const Vec3f& e1, const Vec3f& e2) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3f& p : {corner, corner + e1, corner + e1 + e2, corner + e2})
    mesh.positions.push_back(p);
  for (const Index3& t :
       {Index3{first, first + 1, first + 2}, Index3{first, first + 2, first + 3}}) {
    mesh.triangles.push_back(t);
    mesh.two_sided.push_back(0);
  }
}

/// A box that faces out, or in.
void add_box(TriangleMesh& mesh, const Vec3f& lower, const Vec3f& upper, bool inward) {
  const Vec3f size = upper - lower, x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  const auto face = [&](const Vec3f& corner, const Vec3f& e1, const Vec3f& e2) {
    inward ? add_quad(mesh, corner, e2, e1) : add_quad(mesh, corner, e1, e2);
  };
  face(lower, y, x), face(lower, z, y), face(lower, x, z);
  face(upper, -x, -y), face(upper, -y, -z), face(upper, -z, -x);
}

/// A closed room with two blocks: few triangles, so that rays, labels and counts are what costs.
TriangleMesh box_with_blocks() {
  TriangleMesh mesh;
  add_box(mesh, {0, 0, 0}, {5.5F, 5.5F, 5.6F}, true);
  add_box(mesh, {0.8F, 0.01F, 0.7F}, {2.4F, 1.65F, 2.3F}, false);
  add_box(mesh, {3.1F, 0.01F, 2.5F}, {4.7F, 3.3F, 4.1F}, false);
  return mesh;
}

/// Hills of about a million triangles under a lid: a hierarchy that does not fit the caches.
TriangleMesh hills(std::uint32_t cells) {
  TriangleMesh mesh;
  const float cell = 10.0F / static_cast<float>(cells);
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const float x = static_cast<float>(i) * cell, z = static_cast<float>(j) * cell;
      const float y = 0.3F * std::sin(3 * x) * std::cos(2 * z) + 0.02F * std::sin(47 * x + 31 * z);
      mesh.positions.push_back({x, y, z});
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, b = a + 1, d = a + cells + 1;
      mesh.triangles.push_back({a, d + 1, b});
      mesh.triangles.push_back({a, d, d + 1});
    }
  }
  mesh.two_sided.assign(mesh.triangles.size(), 0);
  add_quad(mesh, {0, 2, 0}, {10, 0, 0}, {0, 0, 10});
  return mesh;
}

void bake(const BvhTracer& scene, float clearance, const Tessellation& tessellation,
          const RowSink& sink) {
  cuda::trace_form_factors(scene.bvh(), clearance, tessellation, {.rays = kRays}, Binning::kPatches,
                           0, sink);
}

SparseCounts gathered(const BvhTracer& scene, float clearance, const Tessellation& tessellation) {
  SparseCounts counts;
  counts.columns = tessellation.patches(), counts.rays = kRays;
  bake(scene, clearance, tessellation,
       [&](std::size_t, const SparseCounts& block, const RayTally&) { append(counts, block); });
  return counts;
}

/// Rays of these rows that the two count in different columns.
std::uint64_t differences(const SparseCounts& device, const SparseCounts& cpu,
                          const std::vector<std::uint32_t>& rows) {
  std::uint64_t sum = 0;
  std::vector<std::int64_t> count(device.columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto columns = device.row_columns(rows[i]), other_columns = cpu.row_columns(i);
    for (std::size_t e = 0; e < columns.size(); ++e)
      count[columns[e]] += device.row_counts(rows[i])[e];
    for (std::size_t e = 0; e < other_columns.size(); ++e)
      count[other_columns[e]] -= cpu.row_counts(i)[e];
    for (std::int64_t& d : count) sum += static_cast<std::uint64_t>(std::abs(d)), d = 0;
  }
  return (sum + 1) / 2;
}

struct Result {
  double device_rate, cpu_rate, seconds_to_build;
  std::uint64_t different, compared;
};

Result measure(const TriangleMesh& mesh, std::size_t patches, std::size_t elements) {
  TessellationConfig cut;
  cut.patches = patches, cut.elements = elements;
  const Tessellation tessellation = tessellate(mesh, cut);
  const BvhTracer scene(mesh);
  const float clearance = ray_epsilon(mesh);
  const SparseCounts counts = gathered(scene, clearance, tessellation);
  const auto drop = [](std::size_t, const SparseCounts&, const RayTally&) {};
  const double device = median_seconds_of([&] { bake(scene, clearance, tessellation, drop); });
  const double build = seconds_of([&] { build_bvh(mesh); });

  // Rows from all over the scene are enough to know the CPU's rate.
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < kCpuRows; ++i)
    rows.push_back(static_cast<std::uint32_t>(i * elements / kCpuRows));
  const ThreadLimit cores(kCpuCores);
  FormFactors expected;
  const double cpu = seconds_of([&] {
    expected = scalar_form_factors(scene, clearance, tessellation, {.rays = kRays},
                                   Binning::kPatches, rows);
  });
  const auto rays = [](std::size_t count) { return static_cast<double>(count) * kRays; };
  return {rays(elements) / device, rays(kCpuRows) / cpu, build,
          differences(counts, expected.counts, rows), std::uint64_t{kCpuRows} * kRays};
}

double report(const char* name, const TriangleMesh& mesh, std::size_t patches,
              std::size_t elements) {
  const Result r = measure(mesh, patches, elements);
  std::printf("%-30s %9zu %9.3f %9.2f %9.1f %9.1f   %llu of %llu\n", name, mesh.triangles.size(),
              r.seconds_to_build, r.device_rate * 1e-6, r.cpu_rate * 1e-6,
              r.device_rate / r.cpu_rate, static_cast<unsigned long long>(r.different),
              static_cast<unsigned long long>(r.compared));
  return r.device_rate / r.cpu_rate;
}

/// Shadow rays as direct light asks for them: there and back again.
void report_batches(const TriangleMesh& mesh) {
  const RayScene scene = cuda::make_ray_scene(mesh, cuda::current_device().index);
  std::vector<Ray> rays(std::size_t{1} << 20);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float x = static_cast<float>(i % 1024) / 1024, y = static_cast<float>(i / 1024) / 1024;
    rays[i] = {{0.1F + 5.3F * x, 5.4F, 0.1F + 5.4F * y}, 0, {0.3F - x, -5, y - 0.4F}, 1};
  }
  std::vector<std::uint8_t> blocked(rays.size());
  const double seconds = median_seconds_of([&] { scene.occluded(rays, blocked); });
  std::printf("\nbatches of 2^20 shadow rays, copies and conversions included: %.1f Mrays/s\n",
              static_cast<double>(rays.size()) / seconds * 1e-6);
}

void run() {
  const cuda::DeviceInfo device = cuda::current_device();
  std::printf("bake, %u rays an element, on %s (sm_%d%d, %d multiprocessors)\n", kRays,
              device.name.c_str(), device.major, device.minor, device.multiprocessors);
  std::printf(
      "Mrays/s of whole bakes but for building the hierarchy (build s); the two cores do what\n");
  std::printf("the device does, which Embree does faster: ./bench bake says how much\n");
  std::printf("%-30s %9s %9s %9s %9s %9s   %s\n", "scene", "triangles", "build s", "device",
              "2 cores", "ratio", "counted differently");
  const double box = report("box with blocks, n = 221,184", box_with_blocks(), 3456, 221184);
  const double large = report("hills, n = 221,184", hills(724), 3456, 221184);
  report_batches(box_with_blocks());
  bench::print_figure("bake.rays_against_two_cores", std::sqrt(box * large), 50, "x");
}

}  // namespace
}  // namespace relumbre

int main() { return relumbre::bench::run_benchmark(relumbre::run); }
