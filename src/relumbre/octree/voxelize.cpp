#include "relumbre/octree/voxelize.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/brick.h"
#include "relumbre/octree/brick_lists.h"
#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

namespace {

/// So many bricks are filled before their voxels are handed on, in order.
constexpr std::size_t kWindow = 128;

void check_depth(unsigned depth) {
  if (depth > kMaxVoxelDepth)
    throw ValueError("depth " + std::to_string(depth) + " is beyond the largest, " +
                     std::to_string(kMaxVoxelDepth));
}

/// Fillers that threads take for a brick and give back.
class FillerPool {
 public:
  FillerPool(const TriangleMesh& mesh, const Cube& cube, const VoxelizeConfig& config)
      : mesh_(mesh), cube_(cube), config_(config) {}

  VoxelBlocks fill(std::uint64_t code, std::span<const std::uint32_t> triangles) {
    BrickFiller filler = take();
    VoxelBlocks blocks = filler.fill(code, triangles);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(filler));
    return blocks;
  }

 private:
  BrickFiller take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return {mesh_, cube_, config_};
    BrickFiller filler = std::move(idle_.back());
    idle_.pop_back();
    return filler;
  }

  const TriangleMesh& mesh_;
  const Cube& cube_;
  const VoxelizeConfig& config_;
  std::mutex mutex_;
  std::vector<BrickFiller> idle_;
};

std::uint64_t fill_bricks(const BrickLists& lists, FillerPool& fillers, const VoxelSink& sink,
                          Progress& progress) {
  std::uint64_t voxels = 0;
  for (std::size_t begin = 0; begin < lists.size(); begin += kWindow) {
    const std::size_t count = std::min(kWindow, lists.size() - begin);
    std::vector<VoxelBlocks> window(count);
    parallel_for(0, count, 1, [&](std::size_t i) {
      window[i] = fillers.fill(lists.brick[begin + i], lists.list(begin + i));
    });
    for (VoxelBlocks& blocks : window) {
      voxels += blocks.voxels();
      if (!blocks.code.empty()) sink(std::move(blocks));
    }
    progress.advance(count);
    progress.check();
  }
  return voxels;
}

}  // namespace

VoxelizeReport voxelize(const TriangleMesh& mesh, const Cube& cube, const VoxelizeConfig& config,
                        const VoxelSink& sink, Progress& progress) {
  check_depth(config.depth);
  const auto passes = plan_passes(mesh, cube, config.depth, config.list_bytes, progress);
  FillerPool fillers(mesh, cube, config);
  VoxelizeReport report{.voxels = 0, .passes = passes.size()};
  for (const BrickRange& range : passes) {
    const BrickLists lists = list_triangles(mesh, cube, config.depth, range, progress);
    progress.begin("voxelize", lists.size());
    report.voxels += fill_bricks(lists, fillers, sink, progress);
  }
  return report;
}

VoxelBlocks voxelize(const TriangleMesh& mesh, const Cube& cube, const VoxelizeConfig& config,
                     Progress& progress) {
  VoxelBlocks all;
  const VoxelSink append = [&all](VoxelBlocks&& blocks) {
    all.code.insert(all.code.end(), blocks.code.begin(), blocks.code.end());
    all.mask.insert(all.mask.end(), blocks.mask.begin(), blocks.mask.end());
    all.value.insert(all.value.end(), blocks.value.begin(), blocks.value.end());
  };
  voxelize(mesh, cube, config, append, progress);
  return all;
}

VoxelizeEstimate estimate_voxelize(const TriangleMesh& mesh, const Cube& cube,
                                   const VoxelizeConfig& config) {
  check_depth(config.depth);
  // A plane of area A and unit normal n crosses A (|nx| + |ny| + |nz|) voxels of unit width.
  double crossed = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3f n = mesh.scaled_normal(t);
    crossed += (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) / 2;
  }
  const double width = cube.edge / std::ldexp(1.0, static_cast<int>(config.depth));
  const double all = std::ldexp(1.0, 3 * static_cast<int>(config.depth));
  const double voxels = std::clamp(crossed / (width * width), 1.0, all);

  // A surface fills about 16 of a block's 64 voxels. A growing array takes twice its size.
  const double blocks = voxels / 16;
  const double tree = blocks * (sizeof(VoxelTree::Node) / 16.0 + sizeof(std::uint64_t));
  const double values =
      config.surface ? blocks * (sizeof(VoxelValue) + sizeof(std::uint64_t)) : 0.0;
  const double window = kWindow * (std::size_t{1} << 18);
  VoxelizeEstimate estimate;
  estimate.voxels = static_cast<std::uint64_t>(voxels);
  estimate.memory_bytes =
      static_cast<std::uint64_t>(2 * (tree + values) + window) + kLeastListBytes;
  estimate.disk_bytes = static_cast<std::uint64_t>(
      tree + values + (config.surface ? voxels * sizeof(VoxelValue) : 0.0));
  return estimate;
}

}  // namespace relumbre
