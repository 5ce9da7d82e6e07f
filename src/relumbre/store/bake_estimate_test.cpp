#include <gtest/gtest.h>

#include "relumbre/base/temporary_folder.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/store/bake.h"
#include "relumbre/store/store.h"
#include "relumbre/store/test_support.h"

namespace relumbre {
namespace {

template <class T>
std::uint64_t bytes_of_all(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

TEST(BakeEstimate, CountsTheSceneAsItIs) {
  const Scene scene = hand_made_scene().scene;
  // 6 vertices with texture coordinates and normals, 2 triangles, 3 texels.
  EXPECT_EQ(estimate_bake(scene, {}).scene_bytes,
            6U * (12 + 8 + 12 + 12) + 2U * (12 + 4 + 4 + 1) + 9U);
}

TEST(BakeEstimate, BoundsWhatABakeMakes) {
  const Scene scene = make_room_scene();
  const TemporaryFolder folder;
  const BakeConfig config{.patches = 300, .elements = 4000, .rays = 64};
  const BakeEstimate estimate = estimate_bake(scene, config);
  const BakeResult result = bake(scene, config, folder / "room.h5");
  const BakedScene baked = read_store(folder / "room.h5");
  const Tessellation& t = baked.tessellation;
  const std::uint64_t tessellation =
      bytes_of_all(t.positions) + bytes_of_all(t.facets) + bytes_of_all(t.facet_offsets) +
      bytes_of_all(t.patch_offsets) + bytes_of_all(t.area) + bytes_of_all(t.centroid) +
      bytes_of_all(t.normal) + bytes_of_all(t.locator.roots) + bytes_of_all(t.locator.nodes) +
      bytes_of_all(baked.reflectance) + bytes_of_all(baked.emission);
  EXPECT_GE(estimate.tessellation_bytes, tessellation);
  EXPECT_LE(estimate.tessellation_bytes, tessellation * 3 / 2);
  EXPECT_GE(estimate.counts_bytes, 8 * baked.counts.nonzeros());
  EXPECT_GE(estimate.disk_bytes, result.file_bytes);
}

TEST(BakeEstimate, PeakIsThatOfTheLargestStage) {
  BakeEstimate estimate;
  estimate.program_bytes = 1000;
  estimate.scene_bytes = 1;
  estimate.tessellation_bytes = 10;
  estimate.tessellate_bytes = 100;
  EXPECT_EQ(estimate.peak_bytes(), 1101U);
  estimate.trace_bytes = 95;
  EXPECT_EQ(estimate.peak_bytes(), 1106U);
  estimate.report_bytes = 200;
  EXPECT_EQ(estimate.peak_bytes(), 1211U);
}

}  // namespace
}  // namespace relumbre
