#include "relumbre/render/view.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/render/camera_rays.h"
#include "relumbre/render/element_points.h"
#include "relumbre/render/primary_hits.h"
#include "relumbre/render/view_shader.h"
#include "relumbre/render/view_tiles.h"

namespace relumbre {

namespace {

constexpr std::uint32_t kMaxSamples = 1U << 14;
/// Samples of one surface differ by less in depth within a pixel.
constexpr float kOneSurface = 0.05F;

using ColorChannels = std::array<const char*, 3>;
constexpr ColorChannels kFront{"R", "G", "B"};
constexpr ColorChannels kBehind{"layer1.R", "layer1.G", "layer1.B"};

void check(const ViewConfig& config) {
  check_view(config, kMaxSamples);
  if (config.layers != 1 && config.layers != 2) {
    throw ValueError(fmt::format("view: {} layers; 1 and 2 are possible", config.layers));
  }
  if (!(config.layer_separation >= 0) || !std::isfinite(config.layer_separation)) {
    throw ValueError(
        fmt::format("view: a separation of layers of {}; it must be finite and not below 0",
                    config.layer_separation));
  }
}

class Renderer {
 public:
  Renderer(const LitScene& in, const Camera& camera, const ViewConfig& config)
      : in_(in),
        config_(config),
        camera_(camera, config.width, config.height),
        shader_(in, config),
        image_(config.width, config.height, channel_names(config)) {}

  Image run(Progress& progress) && {
    for_each_tile(config_.width, config_.height, tile_side(), "view", progress,
                  [&](const ViewTile& tile) {
                    render_center_channels(in_, camera_, tile, image_);
                    render_samples(tile);
                  });
    return std::move(image_);
  }

 private:
  static std::vector<std::string> channel_names(const ViewConfig& config) {
    std::vector<std::string> names{"R",   "G",   "B",        "A",        "Z",       "N.X",
                                   "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"};
    if (config.layers > 1) {
      for (const char* c : {"R", "G", "B", "A", "Z"}) names.push_back(std::string("layer1.") + c);
    }
    return names;
  }

  /// Tiles small enough that a tile's rays take a few megabytes, or as many as the tracer wants.
  [[nodiscard]] std::size_t tile_side() const {
    const std::uint32_t rays = std::max(config_.samples, config_.light_samples);
    const bool long_batches = in_.rays.wants_long_batches();
    const std::size_t most = long_batches ? in_.rays.preferred_batch() : 1U << 14;
    std::size_t side = long_batches ? 512 : 16;
    while (side > 1 && side * side * rays > most) side /= 2;
    return side;
  }

  [[nodiscard]] Ray ray_through(std::size_t pixel, float dx, float dy) const {
    return camera_.through(static_cast<float>(pixel % config_.width) + 0.5F + dx,
                           static_cast<float>(pixel / config_.width) + 0.5F + dy);
  }

  /// samples · pixels rays, those of a pixel together.
  [[nodiscard]] std::vector<Ray> sample_rays(const ViewTile& tile) const {
    std::vector<Ray> rays;
    rays.reserve(tile.pixels() * config_.samples);
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      const std::size_t p = tile.pixel(i);
      const ScrambledSobol sobol(hash64(config_.seed, p));
      for (std::uint32_t s = 0; s < config_.samples; ++s) {
        const std::array<float, 4> u = sobol(s);
        rays.push_back(config_.samples == 1 ? ray_through(p, 0, 0)
                                            : ray_through(p, tent(u[0]), tent(u[1])));
      }
    }
    return rays;
  }

  void render_samples(const ViewTile& tile) {
    const std::vector<Ray> rays = sample_rays(tile);
    std::vector<Hit> hits(rays.size());
    trace_primary(in_.scene, in_.rays, rays, hits);
    render_color(tile, rays, hits, kFront, "A", [](std::size_t) { return true; });
    if (config_.layers > 1) render_behind(tile, rays, hits);
  }

  /// What lies behind is not seen with smooth edges but through a lens: a pixel's colour is that of
  /// the one surface whose depth it tells, without a share of others.
  void render_behind(const ViewTile& tile, std::span<const Ray> rays, std::span<const Hit> hits) {
    const std::vector<Hit> center = behind_centers(tile);
    for (std::size_t i = 0; i < center.size(); ++i)
      image_.channel("layer1.Z")[tile.pixel(i)] = center[i].t;
    std::vector<Hit> behind(rays.size());
    trace_behind(in_.scene, in_.rays, rays, hits, config_.layer_separation, behind);
    render_color(tile, rays, behind, kBehind, "layer1.A", [&](std::size_t s) {
      const Hit& at_center = center[s / config_.samples];
      if (!at_center || !behind[s]) return !at_center && !behind[s];
      return std::abs(behind[s].t - at_center.t) <= kOneSurface * at_center.t;
    });
  }

  /// The means over those of each pixel's samples that count.
  template <class Counts>
  void render_color(const ViewTile& tile, std::span<const Ray> rays, std::span<const Hit> hits,
                    const ColorChannels& color_channels, const char* alpha_channel,
                    Counts&& counts) {
    std::vector<SampleId> ids(rays.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ids[i] = {tile.pixel(i / config_.samples), static_cast<std::uint32_t>(i % config_.samples)};
    }
    std::vector<Rgb> color(rays.size());
    shader_.shade(hits, ids, color);
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      Vec3d sum;
      std::uint32_t covered = 0, counted = 0;
      for (std::size_t s = i * config_.samples; s < (i + 1) * config_.samples; ++s) {
        if (!counts(s)) continue;
        ++counted;
        sum += Vec3d(hits[s] ? color[s] : shader_.background(rays[s].direction));
        covered += hits[s] ? 1 : 0;
      }
      const std::size_t p = tile.pixel(i);
      if (counted == 0) image_.channel("layer1.Z")[p] = 0;  // not known
      const double share = 1.0 / std::max(counted, 1U);
      set_pixel(image_, p, color_channels, Rgb(sum * share));
      image_.channel(alpha_channel)[p] = static_cast<float>(covered * share);
    }
  }

  /// What lies behind along the ray through each pixel's centre.
  [[nodiscard]] std::vector<Hit> behind_centers(const ViewTile& tile) const {
    std::vector<Ray> rays(tile.pixels());
    std::vector<Hit> hits(rays.size()), behind(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = ray_through(tile.pixel(i), 0, 0);
    trace_primary(in_.scene, in_.rays, rays, hits);
    trace_behind(in_.scene, in_.rays, rays, hits, config_.layer_separation, behind);
    return behind;
  }

  const LitScene& in_;
  const ViewConfig& config_;
  CameraRays camera_;
  ViewShader shader_;
  Image image_;
};

}  // namespace

Image render_view(const LitScene& lit_scene, const Camera& camera, const ViewConfig& config,
                  Progress& progress) {
  check(config);
  return Renderer(lit_scene, camera, config).run(progress);
}

}  // namespace relumbre
