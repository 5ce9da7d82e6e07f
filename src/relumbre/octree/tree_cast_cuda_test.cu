#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/octree/test_rays.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/tree_cast_cuda.h"
#include "relumbre/octree/tree_walk.h"
#include "relumbre/octree/voxel_tree_builder.h"

namespace relumbre::cuda {
namespace {

VoxelTree tree_of(const test::VoxelSet& voxels, int depth) {
  return build_tree({}, static_cast<unsigned>(depth), Separating::k26,
                    test::blocks_of(voxels, true));
}

/// Every sort of ray; every third one widens.
std::vector<CastRay> rays_for(int depth, std::size_t count) {
  std::vector<CastRay> rays;
  for (const test::TestRay& ray : test::test_rays(depth, count)) {
    const double spread = rays.size() % 3 == 0 ? 0.05 : 0.0;
    const double t_max = rays.size() % 7 == 0 ? 3.0 : std::numeric_limits<double>::infinity();
    rays.push_back({ray.origin, ray.direction, t_max, spread});
  }
  return rays;
}

/// On the CPU, with the other stack.
std::vector<TreeHit> walk(const VoxelTree& tree, const std::vector<CastRay>& rays) {
  std::vector<TreeHit> hits;
  for (const CastRay& ray : rays) hits.push_back(TreeWalk(tree, ray).first_hit());
  return hits;
}

void expect_same(const std::vector<TreeHit>& hits, const std::vector<TreeHit>& wanted,
                 const std::string& what) {
  std::size_t wrong = 0, hit = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    wrong += hits[i] == wanted[i] ? 0 : 1;
    hit += wanted[i] ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0U) << what << ": of " << hits.size() << " rays";
  EXPECT_GT(hit, hits.size() / 20) << what;
}

TEST(TreeCastCuda, HitsAreThoseOfTheCpuBitForBit) {
  RELUMBRE_NEEDS_DEVICE();
  for (const int depth : {1, 2, 3, 5, 6}) {
    for (const bool is_shell : {true, false}) {
      const VoxelTree tree = tree_of(
          is_shell ? test::shell(depth) : test::random_voxels(depth, std::size_t{1} << 2 * depth),
          depth);
      const std::vector<CastRay> rays = rays_for(depth, 3000);
      std::vector<TreeHit> hits(rays.size());
      DeviceTree(tree).cast(rays, hits);
      expect_same(hits, walk(tree, rays), "depth " + std::to_string(depth));
    }
  }
}

TEST(TreeCastCuda, DeepTreesAreWalkedToTheirEnd) {
  RELUMBRE_NEEDS_DEVICE();
  const VoxelTree tree = tree_of(test::random_voxels(16, 20000), 16);
  // At voxels that are there.
  std::vector<CastRay> rays;
  for (const std::uint64_t code : test::random_voxels(16, 500)) {
    const Cell cell = morton_decode(code);
    rays.push_back({{-5.3, 7.1, -1000.7},
                    Vec3d(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5) - Vec3d(-5.3, 7.1, -1000.7)});
  }
  std::vector<TreeHit> hits(rays.size());
  DeviceTree(tree).cast(rays, hits);
  expect_same(hits, walk(tree, rays), "depth 16");
}

TEST(TreeCastCuda, TilesOfAPictureCoverItOnce) {
  RELUMBRE_NEEDS_DEVICE();
  const int depth = 4;
  const VoxelTree tree = tree_of(test::shell(depth), depth);
  const DeviceTree there(tree);
  const Stream stream;
  for (const std::size_t width : {1, 7, 8, 33}) {
    for (const std::size_t height : {1, 3, 5}) {
      const std::vector<CastRay> rays = rays_for(depth, width * height);
      const auto device_rays = to_device(std::span<const CastRay>(rays), stream);
      DeviceArray<TreeHit> device_hits(rays.size());
      there.cast(device_rays.data(), device_hits.data(), rays.size(), width, stream);
      std::vector<TreeHit> hits(rays.size());
      copy_to_host(device_hits.data(), hits, stream);
      stream.wait();
      const std::vector<TreeHit> wanted = walk(tree, rays);
      for (std::size_t i = 0; i < rays.size(); ++i)
        EXPECT_TRUE(hits[i] == wanted[i]) << width << " x " << height << ", " << i;
    }
  }
}

TEST(TreeCastCuda, EmptyTreesAndNoRays) {
  RELUMBRE_NEEDS_DEVICE();
  std::vector<TreeHit> hits(3, TreeHit{{}, {1, 2, 3}});
  const std::vector<CastRay> rays(3, CastRay{{0, 0, 0}, {1, 0, 0}});
  DeviceTree(VoxelTree()).cast(rays, hits);
  for (const TreeHit& hit : hits) EXPECT_FALSE(hit);
  const VoxelTree tree = tree_of(test::shell(3), 3);
  EXPECT_NO_THROW(DeviceTree(tree).cast(std::span<const CastRay>{}, std::span<TreeHit>{}));
  EXPECT_THROW(DeviceTree(tree).cast(rays, std::span(hits).first(2)), ShapeError);
}

}  // namespace
}  // namespace relumbre::cuda
