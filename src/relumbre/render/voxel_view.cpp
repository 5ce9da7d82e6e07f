#include "relumbre/render/voxel_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/octree/tree_cast.h"
#include "relumbre/render/grid_rays.h"
#include "relumbre/render/view_tiles.h"

namespace relumbre {

namespace {

/// Rows of a picture are cast at a time: so many, or by a caster of its own so many rays.
constexpr std::size_t kRows = 16, kCasterRays = std::size_t{1} << 20;
constexpr std::uint32_t kMaxSamples = 1U << 14;
constexpr std::array kNormalNames{"N.X", "N.Y", "N.Z"};

void check_config(const VoxelViewConfig& config) {
  check_picture_size(config.width, config.height);
  check_samples(config.samples, kMaxSamples);
  if (!(config.detail >= 0 && std::isfinite(config.detail)))
    throw ValueError(fmt::format("view: level of detail of {} pixels", config.detail));
  if (config.detail > 0 && config.traversal)
    throw ValueError("view: level of detail is for the fast traversal alone");
  if (config.caster && config.traversal)
    throw ValueError("view: a caster is for the fast traversal alone");
}

TreeCaster fast_caster(const VoxelTree& tree) {
  return
      [&tree](std::span<const CastRay> rays, std::span<TreeHit> hits) { cast(tree, rays, hits); };
}

TreeCaster words_caster(const VoxelTree& tree, const Traversal& traversal) {
  if (tree.depth() == 0)
    throw ValueError("view: an octree of depth 0 has no words; the fast traversal shows it");
  const auto words = std::make_shared<Octree>(voxel_codes(tree), static_cast<int>(tree.depth()));
  return [&tree, words, traversal](std::span<const CastRay> rays, std::span<TreeHit> hits) {
    parallel_for(0, rays.size(), 1024, [&](std::size_t i) {
      const auto hit = trace(*words, GridRay(rays[i].origin, rays[i].direction), traversal);
      hits[i] = hit ? TreeHit{*hit, *tree.find(hit->cell)} : TreeHit{};
    });
  };
}

TreeCaster caster_of(const VoxelTree& tree, const VoxelViewConfig& config) {
  if (config.caster) return config.caster;
  return config.traversal ? words_caster(tree, *config.traversal) : fast_caster(tree);
}

/// Casts one ray through each pixel of some rows at a time; take(pixel, ray, hit) has the results.
template <class Offset, class Take>
void cast_rows(const TreeCaster& cast, const GridRays& camera, std::size_t width, std::size_t first,
               std::size_t last, const Offset& offset, const Take& take) {
  std::vector<CastRay> rays((last - first) * width);
  std::vector<TreeHit> hits(rays.size());
  parallel_for(0, rays.size(), 1024, [&](std::size_t i) {
    const std::size_t x = i % width, y = first + i / width;
    const Vec2f at = offset(y * width + x);
    rays[i] =
        camera.through(static_cast<float>(x) + 0.5F + at.x, static_cast<float>(y) + 0.5F + at.y);
  });
  cast(rays, hits);
  parallel_for(0, rays.size(), 1024,
               [&](std::size_t i) { take(first * width + i, rays[i], hits[i]); });
}

/// Where in and around its pixel a sample goes, with the density of a tent.
class PixelOffsets {
 public:
  PixelOffsets(const VoxelViewConfig& config, std::uint32_t sample)
      : seed_(config.seed), point_(sobol4(sample)) {}
  Vec2f operator()(std::size_t pixel) const {
    const std::uint64_t turn = hash64(seed_ ^ hash64(pixel));  // a shift of its own a pixel
    const auto shifted = [](std::uint32_t p, std::uint64_t by) {
      return tent(to_unit(p + static_cast<std::uint32_t>(by)));
    };
    return {shifted(point_[0], turn), shifted(point_[1], turn >> 32)};
  }

 private:
  std::uint64_t seed_;
  std::array<std::uint32_t, 4> point_;
};

}  // namespace

Image render_voxels(const VoxelTree& tree, const Camera& camera, const VoxelViewConfig& config,
                    Progress& progress) {
  check_config(config);
  const std::array<std::string, 8> names{"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z"};
  Image image(config.width, config.height, names);
  const GridRays rays(tree.cube(), tree.depth(), camera, config.width, config.height,
                      config.detail);
  const TreeCaster cast = caster_of(tree, config);
  const std::size_t rows = config.caster ? std::max(kRows, kCasterRays / config.width) : kRows;
  const VoxelShader shader(tree, config.shading, config.smooth);
  const auto alpha = image.channel("A"), z = image.channel("Z");
  const float share = 1 / static_cast<float>(config.samples);

  const auto add = [&](std::size_t pixel, const CastRay& ray, const TreeHit& hit) {
    const Rgb color = hit ? shader.color(ray, hit) : config.background;
    image.set_rgb(pixel, image.rgb(pixel) + color * share);
    if (hit) alpha[pixel] += share;
  };

  progress.begin("cast rays", config.height);
  for (std::size_t first = 0; first < config.height; first += rows) {
    const std::size_t last = std::min(config.height, first + rows);
    const auto center = [](std::size_t) { return Vec2f{0, 0}; };
    cast_rows(cast, rays, config.width, first, last, center,
              [&](std::size_t pixel, const CastRay& ray, const TreeHit& hit) {
                z[pixel] =
                    hit ? static_cast<float>(hit.voxel.t) : std::numeric_limits<float>::infinity();
                if (hit) set_pixel(image, pixel, kNormalNames, shader.normal(ray, hit));
                if (config.samples == 1) add(pixel, ray, hit);
              });
    for (std::uint32_t s = 0; config.samples > 1 && s < config.samples; ++s)
      cast_rows(cast, rays, config.width, first, last, PixelOffsets(config, s), add);
    progress.advance(last - first);
    progress.check();
  }
  return image;
}

Camera voxel_camera(const Cube& cube) {
  constexpr float vfov_deg = 35;
  const Vec3f center(cube.corner + Vec3d(cube.edge / 2));
  const float radius = 0.62F * static_cast<float>(cube.edge);
  const float half_angle = vfov_deg / 2 * std::numbers::pi_v<float> / 180;
  const Vec3f direction = normalized(Vec3f(0.45F, 0.35F, 1));
  return {.name = "auto",
          .eye = center + direction * (radius / std::sin(half_angle)),
          .target = center,
          .up = {0, 1, 0},
          .vfov_deg = vfov_deg};
}

}  // namespace relumbre
