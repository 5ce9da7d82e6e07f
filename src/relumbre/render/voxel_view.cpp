#include "relumbre/render/voxel_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/octree/tree_cast.h"
#include "relumbre/render/camera_rays.h"
#include "relumbre/render/view_tiles.h"

namespace relumbre {

namespace {

constexpr std::size_t kRows = 16;  // of a picture, cast at a time
constexpr Rgb kGrey(0.6F);
constexpr std::array kNormalNames{"N.X", "N.Y", "N.Z"};

void check_config(const VoxelViewConfig& config) {
  ViewConfig view;
  view.width = config.width, view.height = config.height, view.samples = config.samples;
  check_view(view, std::uint32_t{1} << 14);
}

/// From metres to the tree's grid; t stays in the same units.
class GridRays {
 public:
  GridRays(const VoxelTree& tree, const Camera& camera, std::size_t width, std::size_t height)
      : tree_(tree), rays_(camera, width, height) {}
  [[nodiscard]] CastRay through(float x, float y) const {
    const Ray ray = rays_.through(x, y);
    const Cube& cube = tree_.cube();
    const double voxels = std::ldexp(1.0, static_cast<int>(tree_.depth())) / cube.edge;
    return {cube.to_voxels(Vec3d(ray.origin), tree_.depth()), Vec3d(ray.direction) * voxels};
  }

 private:
  const VoxelTree& tree_;
  CameraRays rays_;
};

/// What a hit looks like.
struct Look {
  Rgb color = kGrey;
  Vec3f normal;
};

class VoxelShader {
 public:
  VoxelShader(const VoxelTree& tree, const VoxelViewConfig& config)
      : tree_(tree), config_(config) {}

  [[nodiscard]] Rgb color(const CastRay& ray, const TreeHit& hit) const {
    const Look look = look_of(ray, hit);
    switch (config_.shading) {
      case VoxelShading::kColor:
        return look.color;
      case VoxelShading::kNormal:
        return (look.normal + Vec3f(1)) * 0.5F;
      case VoxelShading::kLit:
        break;
    }
    const Vec3f toward_eye = -normalized(Vec3f(ray.direction));
    constexpr float sky = 0.2F, lamp = 0.8F;
    return look.color * (sky + lamp * std::max(0.0F, dot(look.normal, toward_eye)));
  }
  /// Facing the camera.
  [[nodiscard]] Vec3f normal(const CastRay& ray, const TreeHit& hit) const {
    return look_of(ray, hit).normal;
  }

 private:
  [[nodiscard]] Look look_of(const CastRay& ray, const TreeHit& hit) const {
    Look look;
    if (tree_.has_values()) look = config_.smooth ? interpolated(ray, hit) : voxel(hit);
    if (!(length(look.normal) > 0)) look.normal = face_normal(ray, hit);
    if (dot(Vec3d(look.normal), ray.direction) > 0) look.normal = -look.normal;
    return look;
  }
  [[nodiscard]] Look voxel(const TreeHit& hit) const {
    return value(tree_.voxel_index(hit.leaf, hit.bit));
  }
  [[nodiscard]] Look value(std::uint64_t index) const {
    const VoxelValue& v = tree_.values()[index];
    return {unpack_color(v.color), unpack_normal(v.normal)};
  }
  /// Trilinear between the centres of the eight cells around the point that was hit; cells without
  /// a voxel have no say. The voxel itself is one of the eight.
  [[nodiscard]] Look interpolated(const CastRay& ray, const TreeHit& hit) const {
    const Vec3d point = ray.origin + ray.direction * hit.voxel.t - Vec3d(0.5);
    const Vec3d base(std::floor(point.x), std::floor(point.y), std::floor(point.z));
    Look sum{Rgb(), {}};
    float weights = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      float weight = 1;
      std::array<std::uint32_t, 3> cell;
      for (std::size_t a = 0; a < 3; ++a) {
        const bool up = corner >> a & 1;
        const auto fraction = static_cast<float>(point[a] - base[a]);
        weight *= up ? fraction : 1 - fraction;
        cell[a] = static_cast<std::uint32_t>(static_cast<std::int64_t>(base[a]) + (up ? 1 : 0));
      }
      const auto index = tree_.find({cell[0], cell[1], cell[2]});
      if (!index || !(weight > 0)) continue;
      const Look look = value(*index);
      sum.color += look.color * weight;
      sum.normal += look.normal * weight;
      weights += weight;
    }
    if (!(weights > 0)) return voxel(hit);
    return {sum.color / weights, normalized(sum.normal)};
  }
  /// Of the face that the ray came in by; of one that faces it if it began inside.
  static Vec3f face_normal(const CastRay& ray, const TreeHit& hit) {
    if (hit.voxel.axis < 0) return -normalized(Vec3f(ray.direction));
    Vec3f n;
    const auto axis = static_cast<std::size_t>(hit.voxel.axis);
    n[axis] = ray.direction[axis] > 0 ? -1.0F : 1.0F;
    return n;
  }

  const VoxelTree& tree_;
  const VoxelViewConfig& config_;
};

/// Casts one ray through each pixel of some rows at a time; take(pixel, ray, hit) has the results.
template <class Offset, class Take>
void cast_rows(const VoxelTree& tree, const GridRays& camera, std::size_t width, std::size_t first,
               std::size_t last, const Offset& offset, const Take& take) {
  std::vector<CastRay> rays((last - first) * width);
  std::vector<TreeHit> hits(rays.size());
  parallel_for(0, rays.size(), 1024, [&](std::size_t i) {
    const std::size_t x = i % width, y = first + i / width;
    const Vec2f at = offset(y * width + x);
    rays[i] =
        camera.through(static_cast<float>(x) + 0.5F + at.x, static_cast<float>(y) + 0.5F + at.y);
  });
  cast(tree, rays, hits);
  parallel_for(0, rays.size(), 1024,
               [&](std::size_t i) { take(first * width + i, rays[i], hits[i]); });
}

/// Where in and around its pixel a sample goes, with the density of a tent.
class PixelOffsets {
 public:
  PixelOffsets(const VoxelViewConfig& config, std::uint32_t sample)
      : center_(config.samples == 1), seed_(config.seed), point_(sobol4(sample)) {}
  Vec2f operator()(std::size_t pixel) const {
    if (center_) return {0, 0};
    const std::uint64_t turn = hash64(seed_ ^ hash64(pixel));  // a shift of its own a pixel
    const auto shifted = [](std::uint32_t p, std::uint64_t by) {
      return tent(to_unit(p + static_cast<std::uint32_t>(by)));
    };
    return {shifted(point_[0], turn), shifted(point_[1], turn >> 32)};
  }

 private:
  bool center_;
  std::uint64_t seed_;
  std::array<std::uint32_t, 4> point_;
};

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

Image render_voxels(const VoxelTree& tree, const Camera& camera, const VoxelViewConfig& config,
                    Progress& progress) {
  check_config(config);
  const std::array<std::string, 8> names{"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z"};
  Image image(config.width, config.height, names);
  const GridRays rays(tree, camera, config.width, config.height);
  const VoxelShader shader(tree, config);
  const auto alpha = image.channel("A"), z = image.channel("Z");
  const float share = 1 / static_cast<float>(config.samples);

  progress.begin("cast rays", config.height);
  for (std::size_t first = 0; first < config.height; first += kRows) {
    const std::size_t last = std::min(config.height, first + kRows);
    const auto center = [](std::size_t) { return Vec2f{0, 0}; };
    cast_rows(tree, rays, config.width, first, last, center,
              [&](std::size_t pixel, const CastRay& ray, const TreeHit& hit) {
                z[pixel] =
                    hit ? static_cast<float>(hit.voxel.t) : std::numeric_limits<float>::infinity();
                if (hit) set_pixel(image, pixel, kNormalNames, shader.normal(ray, hit));
              });
    for (std::uint32_t s = 0; s < config.samples; ++s) {
      cast_rows(tree, rays, config.width, first, last, PixelOffsets(config, s),
                [&](std::size_t pixel, const CastRay& ray, const TreeHit& hit) {
                  const Rgb color = hit ? shader.color(ray, hit) : config.background;
                  image.set_rgb(pixel, image.rgb(pixel) + color * share);
                  if (hit) alpha[pixel] += share;
                });
    }
    progress.advance(last - first);
    progress.check();
  }
  return image;
}

Image traversal_heat_map(const VoxelTree& tree, const Camera& camera, std::size_t width,
                         std::size_t height, const Traversal& traversal, const std::string& shown,
                         Progress& progress) {
  check_config({.width = width, .height = height});
  std::vector<std::uint64_t> codes;
  codes.reserve(tree.voxels());
  for_each_voxel(tree, [&](std::uint64_t code, std::uint64_t) { codes.push_back(code); });
  const Octree octree(codes, static_cast<int>(tree.depth()));
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

Camera voxel_camera(const VoxelTree& tree) {
  constexpr float vfov_deg = 35;
  const Cube& cube = tree.cube();
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
