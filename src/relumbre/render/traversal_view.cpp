#include "relumbre/render/traversal_view.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "relumbre/image/heat_map.h"
#include "relumbre/render/grid_rays.h"
#include "relumbre/render/view_tiles.h"

namespace relumbre {

namespace {

/// Counts what a traversal does for one ray.
struct CountingObserver {
  std::uint32_t visits = 0, reads = 0;
  int level = 0;
  void begin_ray(const GridRay&) {}
  void visit(LocationCode, int at) {
    ++visits;
    level = std::max(level, at);
  }
  void read(LocationCode, int) { ++reads; }
  void restart() {}
};

}  // namespace

Image traversal_heat_map(const VoxelTree& tree, const Camera& camera, std::size_t width,
                         std::size_t height, const Traversal& traversal, const std::string& shown,
                         Progress& progress) {
  check_picture_size(width, height);
  const Octree octree(voxel_codes(tree), static_cast<int>(tree.depth()));
  const std::array<std::string, 6> names{"R", "G", "B", "visits", "reads", "level"};
  Image image(width, height, names);
  const auto visits = image.channel("visits"), reads = image.channel("reads"),
             level = image.channel("level");
  const GridRays rays(tree.cube(), tree.depth(), camera, width, height);

  for_each_tile(width, height, 64, "traverse", progress, [&](const ViewTile& tile) {
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      const std::size_t pixel = tile.pixel(i);
      const CastRay ray = rays.through_center(pixel % width, pixel / width);
      CountingObserver counts;
      (void)trace(octree, GridRay(ray.origin, ray.direction), traversal, counts);
      visits[pixel] = static_cast<float>(counts.visits);
      reads[pixel] = static_cast<float>(counts.reads);
      level[pixel] = static_cast<float>(counts.level);
    }
  });
  paint_heat(image, shown);
  return image;
}

}  // namespace relumbre
