#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/cuda/device.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/octree/tree_cast_cuda.h"
#include "relumbre/octree/tree_walk.h"

namespace relumbre::cuda {

namespace {

constexpr unsigned kThreads = 128;
/// Rays in flight at a time, 15 MB of them and their hits.
constexpr std::size_t kBatch = std::size_t{1} << 17;

/// A VoxelTree as the walk sees it, by pointers.
class TreePointers {
 public:
  using Node = VoxelTree::Node;

  [[nodiscard]] __device__ const std::uint64_t* leaves() const { return leaves_; }
  [[nodiscard]] __device__ const Node* nodes(unsigned level) const { return nodes_[level]; }
  [[nodiscard]] __device__ unsigned levels() const { return levels_; }
  [[nodiscard]] __device__ unsigned depth() const { return depth_; }
  [[nodiscard]] __device__ std::uint32_t child_edge(unsigned level) const {
    return std::uint32_t{1} << 2 * (levels_ - 1 - level);
  }
  __device__ static std::uint64_t rank(std::uint64_t mask, unsigned bit) {
    return static_cast<std::uint64_t>(__popcll(mask & ((std::uint64_t{1} << bit) - 1)));
  }

  const Node* nodes_[VoxelTree::kMaxLevels] = {};
  const std::uint64_t* leaves_ = nullptr;
  unsigned levels_ = 0, depth_ = 0;
};

/// Which ray a thread takes: in tiles of 8 × 4 pixels where the rays are a picture, so that a
/// warp's rays stay together. Beyond the picture's last whole tiles: count, none.
__device__ std::size_t ray_of(std::size_t thread, std::size_t count, std::size_t width) {
  if (width == 0) return thread;
  const std::size_t tiles_across = (width + 7) / 8, tile = thread / 32, in = thread % 32;
  const std::size_t x = tile % tiles_across * 8 + in % 8, y = tile / tiles_across * 4 + in / 8;
  return x < width ? y * width + x : count;
}

__global__ void __launch_bounds__(kThreads)
    cast_rays(const __grid_constant__ TreePointers tree, const CastRay* rays, TreeHit* hits,
              std::size_t count, std::size_t width) {
  const std::size_t thread = std::size_t{blockIdx.x} * kThreads + threadIdx.x;
  const std::size_t i = ray_of(thread, count, width);
  if (i < count) hits[i] = TreeWalk<TreePointers, IndexStack>(tree, rays[i]).first_hit();
}

/// One of the two batches on their way.
struct Lane {
  Stream stream;
  PinnedArray<CastRay> here_rays;
  PinnedArray<TreeHit> here_hits;
  DeviceArray<CastRay> rays;
  DeviceArray<TreeHit> hits;
  std::span<TreeHit> wanted;  ///< where the hits go

  void reserve(std::size_t count) {
    here_rays.reserve(count), here_hits.reserve(count);
    rays.reserve(count), hits.reserve(count);
  }
  /// Waits for the batch before this one.
  void finish() {
    if (wanted.empty()) return;
    stream.wait();
    parallel_chunks(0, wanted.size(), 1 << 14, [this](std::size_t first, std::size_t last) {
      std::copy(here_hits.data() + first, here_hits.data() + last, wanted.data() + first);
    });
    wanted = {};
  }
};

}  // namespace

struct DeviceTree::Parts {
  int device = 0;
  std::array<DeviceArray<VoxelTree::Node>, VoxelTree::kMaxLevels> nodes;
  DeviceArray<std::uint64_t> leaves;
  TreePointers pointers;
  std::array<Lane, 2> lanes;
};

std::size_t DeviceTree::device_bytes(const VoxelTree& tree) {
  return tree.geometry_bytes() + 2 * kBatch * (sizeof(CastRay) + sizeof(TreeHit));
}

DeviceTree::DeviceTree(const VoxelTree& tree) {
  expect_free(device_bytes(tree), "voxel tree");
  parts_ = std::make_unique<Parts>();
  parts_->device = current_device().index;
  const Stream& stream = parts_->lanes[0].stream;
  TreePointers& to = parts_->pointers;
  to.levels_ = tree.levels(), to.depth_ = tree.depth();
  for (unsigned level = 0; level + 1 < tree.levels(); ++level) {
    parts_->nodes[level] = to_device(tree.nodes(level), stream);
    to.nodes_[level] = parts_->nodes[level].data();
  }
  parts_->leaves = to_device(tree.leaves(), stream);
  to.leaves_ = parts_->leaves.data();
}

DeviceTree::~DeviceTree() = default;
DeviceTree::DeviceTree(DeviceTree&&) noexcept = default;
DeviceTree& DeviceTree::operator=(DeviceTree&&) noexcept = default;

void DeviceTree::cast(const CastRay* rays, TreeHit* hits, std::size_t count, std::size_t width,
                      const Stream& stream) const {
  const std::size_t rows = width == 0 ? 0 : (count + width - 1) / width;
  const std::size_t threads = width == 0 ? count : (width + 7) / 8 * ((rows + 3) / 4) * 32;
  launch(
      cast_rays,
      {.blocks = static_cast<unsigned>((threads + kThreads - 1) / kThreads), .threads = kThreads},
      stream, parts_->pointers, rays, hits, count, width);
}

void DeviceTree::cast(std::span<const CastRay> rays, std::span<TreeHit> hits) const {
  if (rays.size() != hits.size())
    throw ShapeError("cast: " + std::to_string(rays.size()) + " rays, " +
                     std::to_string(hits.size()) + " hits");
  if (parts_->leaves.empty()) {
    std::fill(hits.begin(), hits.end(), TreeHit{});
    return;
  }
  const UseDevice use(parts_->device);
  std::size_t turn = 0;
  for (std::size_t first = 0; first < rays.size(); first += kBatch, ++turn) {
    const std::size_t count = std::min(kBatch, rays.size() - first);
    Lane& lane = parts_->lanes[turn % 2];
    lane.finish();
    lane.reserve(count);
    std::copy_n(rays.data() + first, count, lane.here_rays.data());
    copy_to_device<CastRay>(values_of(lane.here_rays).first(count), lane.rays.data(), lane.stream);
    cast(lane.rays.data(), lane.hits.data(), count, 0, lane.stream);
    copy_to_host(lane.hits.data(), values_of(lane.here_hits).first(count), lane.stream);
    lane.wanted = hits.subspan(first, count);
  }
  for (Lane& lane : parts_->lanes) lane.finish();
}

}  // namespace relumbre::cuda
