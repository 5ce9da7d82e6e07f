// From triangles to an octree: the time of the bunny at 1024³ against a textbook voxeliser on one
// thread, and what the octree of the dragon takes.

#include <fmt/format.h>

#include "packed_scene.h"
#include "relumbre/octree/voxel_tree_builder.h"
#include "report.h"
#include "textbook_voxelizer.h"
#include "voxel_scene.h"

namespace relumbre::bench {
namespace {

SurfaceSampler materials(const Scene& scene) {
  return [&scene](std::uint32_t t, float u, float v) {
    return SurfaceSample{scene.reflectance(t, u, v), scene.mesh.scaled_normal(t)};
  };
}

VoxelTree build_textbook(const Scene& scene, unsigned depth) {
  const Cube cube = cube_around(bounds(scene.mesh.positions));
  VoxelBlocks blocks;
  for (const std::uint64_t code : textbook_voxels(scene.mesh, cube, depth)) {
    if (blocks.code.empty() || blocks.code.back() != code >> 6) {
      blocks.code.push_back(code >> 6);
      blocks.mask.push_back(0);
    }
    blocks.mask.back() |= std::uint64_t{1} << (code & 63);
  }
  return build_tree(cube, depth, Separating::k26, blocks);
}

void compare(Report& report, const std::string& name, const Scene& scene, unsigned depth) {
  const VoxelizeConfig conservative{.depth = depth, .surface = {}};
  VoxelizeConfig thin = conservative, colored = conservative;
  thin.separating = Separating::k6;
  colored.surface = materials(scene);
  VoxelTree ours, peer;
  const std::function<void()> candidates[] = {
      [&] { ours = build_voxels(scene, conservative); }, [&] { build_voxels(scene, thin); },
      [&] { build_voxels(scene, colored); }, [&] { peer = build_textbook(scene, depth); }};
  const std::vector<double> seconds = median_seconds(candidates, 5);
  const char* const kinds[] = {"conservative", "thin", "with colours and normals"};
  for (std::size_t i = 0; i < 3; ++i) {
    report.add({.name = fmt::format("{}, depth {}, {}", name, depth, kinds[i]),
                .ours_ms = 1e3 * seconds[i],
                .peer = "textbook, 1 thread",
                .peer_ms = 1e3 * seconds[3]});
  }
  report.figure(fmt::format("{}: voxels", name), static_cast<double>(ours.voxels()), "");
  report.figure(fmt::format("{}: textbook's voxels", name), static_cast<double>(peer.voxels()), "");
}

void report_size(Report& report, const std::string& name, const Scene& scene, unsigned depth) {
  const VoxelTree tree = build_voxels(scene, {.depth = depth, .surface = {}});
  const auto voxels = static_cast<double>(tree.voxels());
  report.figure(fmt::format("{}, depth {}: voxels", name, depth), voxels, "");
  report.figure(fmt::format("{}, depth {}: geometry", name, depth),
                static_cast<double>(tree.geometry_bytes()) / voxels, "bytes a voxel");
}

int run(int argc, char** argv) {
  Report report("voxelize", argc, argv);
  const auto bunny = read_packed_scene("stanford/bun_zipper.ply");
  const auto dragon = read_packed_scene("stanford/dragon_q11.ply");
  if (!bunny || !dragon) {
    report.note("skipped: RELUMBRE_DATA has no stanford/bun_zipper.ply.xz, dragon_q11.ply.xz");
    return report.finish();
  }
  report.heading("triangles to octree");
  compare(report, "bunny", *bunny, 10);
  compare(report, "dragon", *dragon, 10);
  for (const unsigned depth : {9U, 10U, 11U}) report_size(report, "dragon", *dragon, depth);
  report_size(report, "bunny", *bunny, 10);
  return report.finish();
}

}  // namespace
}  // namespace relumbre::bench

int main(int argc, char** argv) {
  return relumbre::bench::run_benchmark(relumbre::bench::run, argc, argv);
}
