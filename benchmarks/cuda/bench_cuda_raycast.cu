// Rays a second through a voxel octree on a GPU, primary and secondary, against the CPU's walk.
//
//   bench_cuda_raycast [FILE.rlo]     without a file: a bumpy ball at depth 11
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "bench.cuh"
#include "bumpy_ball.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/octree/rlo_file.h"
#include "relumbre/octree/tree_cast_cuda.h"
#include "relumbre/octree/tree_walk.h"

namespace relumbre::bench {
namespace {

constexpr std::size_t kWidth = 1920, kHeight = 1080;
std::string file;  ///< NOLINT: the program's argument

/// A pinhole that sees all of the cube, in voxels.
std::vector<CastRay> primary_rays(const VoxelTree& tree) {
  const double edge = std::ldexp(1.0, static_cast<int>(tree.depth()));
  const Vec3d center(edge / 2), eye = center + Vec3d(0.55, 0.4, 1.3) * edge;
  const Vec3d forward = normalized(center - eye),
              right = normalized(cross(forward, Vec3d(0, 1, 0)));
  const Vec3d up = cross(right, forward);
  std::vector<CastRay> rays(kWidth * kHeight);
  parallel_for(0, rays.size(), 4096, [&](std::size_t i) {
    const double x = (static_cast<double>(i % kWidth) + 0.5 - kWidth / 2.0) / kHeight;
    const double y = (kHeight / 2.0 - static_cast<double>(i / kWidth) - 0.5) / kHeight;
    rays[i] = {eye, forward + right * (0.7 * x) + up * (0.7 * y)};
  });
  return rays;
}

/// From where the primary rays hit, in random directions of the hemisphere about the face.
std::vector<CastRay> secondary_rays(const std::vector<CastRay>& primary,
                                    const std::vector<TreeHit>& hits) {
  std::vector<CastRay> rays;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i] || hits[i].voxel.axis < 0) continue;
    RandomStream random(i);
    const auto axis = static_cast<std::size_t>(hits[i].voxel.axis);
    const Vec3f d = square_to_sphere(random.uniform(), random.uniform());
    Vec3d direction(d);
    const double side = primary[i].direction[axis] > 0 ? -1 : 1;
    direction[axis] = side * (1e-3 + std::abs(direction[axis]));
    Vec3d origin = primary[i].origin + primary[i].direction * hits[i].voxel.t;
    origin[axis] += side * 1e-3;
    rays.push_back({origin, direction});
  }
  return rays;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Casts on both sides, compares, and returns the device's hits.
std::vector<TreeHit> measure(const char* name, const VoxelTree& tree, const cuda::DeviceTree& there,
                             const std::vector<CastRay>& rays, std::size_t width,
                             double& rays_per_second) {
  const cuda::Stream stream;
  const auto device_rays = cuda::to_device(std::span<const CastRay>(rays), stream);
  const cuda::DeviceArray<TreeHit> device_hits(rays.size());
  const Work cast = [&](const cuda::Stream& s) {
    there.cast(device_rays.data(), device_hits.data(), rays.size(), width, s);
  };
  rays_per_second = static_cast<double>(rays.size()) / median_seconds({&cast, 1}, stream)[0];
  std::vector<TreeHit> hits(rays.size()), here(rays.size());
  cuda::copy_to_host(device_hits.data(), hits, stream);
  stream.wait();
  const auto start = std::chrono::steady_clock::now();
  parallel_for(0, rays.size(), 4096,
               [&](std::size_t i) { here[i] = TreeWalk(tree, rays[i]).first_hit(); });
  const double cpu = static_cast<double>(rays.size()) / seconds_since(start);
  std::size_t wrong = 0, hit = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    wrong += hits[i] == here[i] ? 0 : 1, hit += hits[i] ? 1 : 0;
  std::printf("%-10s %10zu %8.1f%% %12.1f %14.2f %10.1f %8zu\n", name, rays.size(),
              100 * static_cast<double>(hit) / static_cast<double>(rays.size()),
              rays_per_second * 1e-6, cpu * 1e-6, rays_per_second / cpu, wrong);
  return hits;
}

void run() {
  const cuda::DeviceInfo device = cuda::current_device();
  const VoxelTree tree = file.empty() ? bumpy_ball(11) : read_rlo(file).tree;
  std::printf("cast, on %s: %s, depth %u, %llu voxels\n", device.name.c_str(),
              file.empty() ? "bumpy ball" : file.c_str(), tree.depth(),
              static_cast<unsigned long long>(tree.voxels()));
  std::printf("%-10s %10s %9s %12s %14s %10s %8s\n", "rays", "count", "hit", "Mray/s", "CPU walk",
              "ratio", "wrong");
  const cuda::DeviceTree there(tree);
  double primary_speed = 0, secondary_speed = 0;
  const std::vector<CastRay> primary = primary_rays(tree);
  const std::vector<TreeHit> hits = measure("primary", tree, there, primary, kWidth, primary_speed);
  const std::vector<CastRay> secondary = secondary_rays(primary, hits);
  measure("secondary", tree, there, secondary, 0, secondary_speed);
  std::printf("CPU walk: one ray after the other on %zu threads\n", thread_count());
  print_figure("raycast_primary_gray_s", primary_speed * 1e-9, 1, "Gray/s");
}

}  // namespace
}  // namespace relumbre::bench

int main(int argc, char** argv) {
  if (argc > 1) relumbre::bench::file = argv[1];
  return relumbre::bench::run_benchmark(relumbre::bench::run);
}
