#include "relumbre/render/traversal_view.h"

#include <algorithm>
#include <array>
#include <cstdint>

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

/// From 0 to 1: dark blue, red, yellow, white.
Rgb heat(float v) {
  const auto ramp = [v](float from, float to) {
    return std::clamp((v - from) / (to - from), 0.0F, 1.0F);
  };
  return {ramp(0.1F, 0.5F), ramp(0.4F, 0.8F),
          0.25F * ramp(0, 0.1F) * (1 - ramp(0.3F, 0.5F)) + ramp(0.75F, 1)};
}

}  // namespace

Image traversal_heat_map(const VoxelTree& tree, const Camera& camera, std::size_t width,
                         std::size_t height, const Traversal& traversal, const std::string& shown,
                         Progress& progress) {
  check_picture_size(width, height);
  const Octree octree(voxel_codes(tree), static_cast<int>(tree.depth()));
  const std::array<std::string, 6> names{"R", "G", "B", "visits", "reads", "level"};
  Image image(width, height, names);
  const auto visits = image.channel("visits"), reads = image.channel("reads"),
             level = image.channel("level"), show = image.channel(shown);
  const GridRays rays(tree, camera, width, height);

  for_each_tile(width, height, 64, "traverse", progress, [&](const ViewTile& tile) {
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      const std::size_t pixel = tile.pixel(i);
      const CastRay ray = rays.through(static_cast<float>(pixel % width) + 0.5F,
                                       static_cast<float>(pixel / width) + 0.5F);
      CountingObserver counts;
      (void)trace(octree, GridRay(ray.origin, ray.direction), traversal, counts);
      visits[pixel] = static_cast<float>(counts.visits);
      reads[pixel] = static_cast<float>(counts.reads);
      level[pixel] = static_cast<float>(counts.level);
    }
  });
  const float most = std::max(1.0F, *std::ranges::max_element(show));
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel)
    image.set_rgb(pixel, heat(show[pixel] / most));
  return image;
}

}  // namespace relumbre
