// What the triangles cover, their conservative voxels cover: no ray slips through.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "packed_scene.h"
#include "relumbre/octree/voxel_tree_builder.h"
#include "relumbre/octree/voxelize.h"
#include "relumbre/render/grid_rays.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {
namespace {

struct Cover {
  std::size_t triangles = 0, voxels = 0, triangles_alone = 0, voxels_behind = 0;
};

/// One ray through each pixel's centre, through triangles by Embree and through voxels.
Cover cover(const Scene& scene, unsigned depth, std::size_t width, std::size_t height) {
  const Cube cube = cube_around(bounds(scene.mesh.positions));
  const VoxelTree tree = build_tree(cube, depth, Separating::k26,
                                    voxelize(scene.mesh, cube, {.depth = depth, .surface = {}}));
  const RayScene triangles(scene.mesh);
  const Camera camera = auto_camera(scene);
  const CameraRays metres(camera, width, height);
  const GridRays grid(cube, depth, camera, width, height);
  std::vector<CastRay> rays;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) rays.push_back(grid.through_center(x, y));
  std::vector<TreeHit> hits(rays.size());
  cast(tree, rays, hits);

  Cover cover;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit hit = triangles.closest(
        metres.through(static_cast<float>(i % width) + 0.5F, static_cast<float>(i / width) + 0.5F));
    cover.triangles += bool{hit};
    cover.voxels += bool{hits[i]};
    cover.triangles_alone += hit && !hits[i];
    // The voxel begins before the surface in it; float32 triangles are a little off.
    if (hit && hits[i])
      cover.voxels_behind += hits[i].voxel.t > static_cast<double>(hit.t) * (1 + 1e-5);
  }
  return cover;
}

void expect_covered(const Cover& cover) {
  EXPECT_EQ(cover.triangles_alone, 0U) << "of " << cover.triangles << " covered pixels";
  EXPECT_EQ(cover.voxels_behind, 0U);
  EXPECT_GE(cover.voxels, cover.triangles);
  EXPECT_LT(static_cast<double>(cover.voxels), 1.2 * static_cast<double>(cover.triangles));
}

TEST(Silhouette, OfVoxelsCoversThatOfTheBuiltInScenes) {
  for (const char* name : {"teapots", "cornell", "room"})
    expect_covered(cover(make_builtin_scene(name), 8, 320, 180));
}

TEST(Silhouette, OfTheDragonAtDepth10CoversThatOfItsTriangles) {
  const auto dragon = bench::read_packed_scene("stanford/dragon_q11.ply");
  if (!dragon) GTEST_SKIP() << "RELUMBRE_DATA has no stanford/dragon_q11.ply.xz";
  const Cover dragons = cover(*dragon, 10, 1280, 720);
  EXPECT_GT(dragons.triangles, 10'000U);
  RecordProperty("pixels", static_cast<int>(dragons.triangles));
  expect_covered(dragons);
}

}  // namespace
}  // namespace relumbre
