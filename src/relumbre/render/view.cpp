#include "relumbre/render/view.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/render/camera_rays.h"
#include "relumbre/render/element_points.h"
#include "relumbre/render/pixel_light.h"
#include "relumbre/render/primary_hits.h"
#include "relumbre/render/shading.h"
#include "relumbre/render/sky_light.h"

namespace relumbre {

namespace {

constexpr std::uint32_t kMaxSamples = 1U << 14;
constexpr std::size_t kMaxPixels = std::size_t{1} << 28;

void check(const ViewConfig& config) {
  const bool too_many = config.width != 0 && config.height > kMaxPixels / config.width;
  if (config.width == 0 || config.height == 0 || too_many) {
    throw ValueError(fmt::format("view: an image of {} by {} pixels; 1 to 2^28 in all are possible",
                                 config.width, config.height));
  }
  for (const std::uint32_t samples : {config.samples, config.light_samples}) {
    if (samples == 0 || samples > kMaxSamples) {
      throw ValueError(fmt::format("view: {} samples; 1 to {} are possible", samples, kMaxSamples));
    }
  }
}

/// A uniform number to [-1, 1] with the density of a tent.
float tent(float u) {
  return u < 0.5F ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(std::max(0.0F, 2 - 2 * u));
}

struct Tile {
  std::size_t x0, y0, x1, y1;
  [[nodiscard]] std::size_t width() const { return x1 - x0; }
  [[nodiscard]] std::size_t pixels() const { return width() * (y1 - y0); }
};

class Renderer {
 public:
  Renderer(const LitScene& in, const Camera& camera, const ViewConfig& config)
      : in_(in),
        config_(config),
        camera_(camera, config.width, config.height),
        powers_(object_powers(in.scene, in.lights)),
        field_(in.tessellation, in.display, interpolated(in, config)),
        image_(config.width, config.height, channel_names()) {
    if (config.mode == ViewMode::kDirectPerPixel) {
      direct_.emplace(in.scene, in.rays, in.lights, config.samples, config.light_samples,
                      config.seed);
    }
    for (const Light& light : in.lights) {
      if (light.type != LightType::kSky || light.power() == Rgb{}) continue;
      skies_.push_back({SkyMap(light), light.power() * std::numbers::pi_v<float>});
    }
  }

  Image run(Progress& progress) && {
    const std::size_t side = tile_side();
    const std::size_t columns = (config_.width + side - 1) / side;
    const std::size_t rows = (config_.height + side - 1) / side;
    progress.begin("view", config_.width * config_.height);
    parallel_for(0, columns * rows, 1, [&](std::size_t i) {
      progress.check();
      const std::size_t x = i % columns * side, y = i / columns * side;
      const Tile tile{x, y, std::min(x + side, config_.width), std::min(y + side, config_.height)};
      render_center_channels(tile);
      render_color(tile);
      progress.advance(tile.pixels());
    });
    return std::move(image_);
  }

 private:
  struct Sky {
    SkyMap map;
    Rgb scale;
  };

  static std::vector<std::string> channel_names() {
    return {"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"};
  }

  /// The part of the irradiance that is not measured at each pixel.
  static std::vector<Rgb> interpolated(const LitScene& in, const ViewConfig& config) {
    ShadingInput shading =
        shading_input(in.tessellation, in.display, in.lit, in.reflectance, config.smoothing_passes);
    if (config.mode == ViewMode::kDirectPerPixel) return std::move(shading.indirect);
    for (std::size_t i = 0; i < shading.indirect.size(); ++i) {
      shading.indirect[i] += shading.direct[i];
    }
    return std::move(shading.indirect);
  }

  /// Tiles small enough that a tile's rays take a few megabytes.
  [[nodiscard]] std::size_t tile_side() const {
    const std::uint32_t rays = std::max(config_.samples, config_.light_samples);
    std::size_t side = 16;
    while (side > 1 && side * side * rays > (1U << 14)) side /= 2;
    return side;
  }

  [[nodiscard]] std::size_t pixel(const Tile& tile, std::size_t i) const {
    return (tile.y0 + i / tile.width()) * config_.width + tile.x0 + i % tile.width();
  }

  [[nodiscard]] Ray ray_through(std::size_t pixel, float dx, float dy) const {
    return camera_.through(static_cast<float>(pixel % config_.width) + 0.5F + dx,
                           static_cast<float>(pixel / config_.width) + 0.5F + dy);
  }

  void render_center_channels(const Tile& tile) {
    std::vector<Ray> rays(tile.pixels());
    std::vector<Hit> hits(tile.pixels());
    for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = ray_through(pixel(tile, i), 0, 0);
    trace_primary(in_.scene, in_.rays, rays, hits);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const std::size_t p = pixel(tile, i);
      image_.channel("Z")[p] = hits[i].t;
      if (!hits[i]) continue;
      const Surface surface = surface_at(in_.scene, hits[i]);
      set(p, {"N.X", "N.Y", "N.Z"}, surface.normal);
      set(p, {"albedo.R", "albedo.G", "albedo.B"}, surface.reflectance);
    }
  }

  void set(std::size_t p, const std::array<const char*, 3>& channels, const Vec3f& value) {
    for (std::size_t c = 0; c < 3; ++c) image_.channel(channels[c])[p] = value[c];
  }

  /// samples · pixels rays, those of a pixel together.
  [[nodiscard]] std::vector<Ray> sample_rays(const Tile& tile) const {
    std::vector<Ray> rays;
    rays.reserve(tile.pixels() * config_.samples);
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      const std::size_t p = pixel(tile, i);
      const ScrambledSobol sobol(hash64(config_.seed, p));
      for (std::uint32_t s = 0; s < config_.samples; ++s) {
        const std::array<float, 4> u = sobol(s);
        rays.push_back(config_.samples == 1 ? ray_through(p, 0, 0)
                                            : ray_through(p, tent(u[0]), tent(u[1])));
      }
    }
    return rays;
  }

  void render_color(const Tile& tile) {
    const std::vector<Ray> rays = sample_rays(tile);
    std::vector<Hit> hits(rays.size());
    trace_primary(in_.scene, in_.rays, rays, hits);
    std::vector<Rgb> direct(rays.size());
    if (direct_) gather_direct(tile, hits, direct);
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
      Vec3d sum;
      std::uint32_t covered = 0;
      for (std::size_t s = i * config_.samples; s < (i + 1) * config_.samples; ++s) {
        sum += Vec3d(hits[s] ? radiosity(hits[s], direct[s]) : background(rays[s]));
        covered += hits[s] ? 1 : 0;
      }
      const std::size_t p = pixel(tile, i);
      set(p, {"R", "G", "B"}, Rgb(sum / static_cast<double>(config_.samples)));
      image_.channel("A")[p] = static_cast<float>(covered) / static_cast<float>(config_.samples);
    }
  }

  /// Direct irradiance at each hit of a tile's samples.
  void gather_direct(const Tile& tile, std::span<const Hit> hits, std::span<Rgb> direct) const {
    std::vector<PixelSample> samples(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
      samples[i].pixel = pixel(tile, i / config_.samples);
      samples[i].index = static_cast<std::uint32_t>(i % config_.samples);
      if (!hits[i]) continue;
      const Surface surface = surface_at(in_.scene, hits[i]);
      samples[i].receiver = {surface.position + surface.normal * in_.rays.epsilon(),
                             surface.shading_normal};
      samples[i].lit = true;
    }
    direct_->gather(samples, direct);
  }

  [[nodiscard]] Rgb radiosity(const Hit& hit, const Rgb& direct) const {
    const Rgb irradiance = field_.at(hit.triangle, hit.back, hit.u, hit.v) + direct;
    const Rgb emission =
        in_.scene.material_of(hit.triangle).emission * powers_[in_.scene.mesh.object[hit.triangle]];
    return emission + in_.scene.reflectance(hit.triangle, hit.u, hit.v) * irradiance;
  }

  [[nodiscard]] Rgb background(const Ray& ray) const {
    if (skies_.empty()) return config_.background;
    Rgb sum;
    for (const Sky& sky : skies_) sum += sky.map.radiance(normalized(ray.direction)) * sky.scale;
    return sum;
  }

  const LitScene& in_;
  const ViewConfig& config_;
  CameraRays camera_;
  std::vector<Rgb> powers_;
  DisplayField field_;
  std::optional<PixelLight> direct_;
  std::vector<Sky> skies_;
  Image image_;
};

}  // namespace

Image render_view(const LitScene& lit_scene, const Camera& camera, const ViewConfig& config,
                  Progress& progress) {
  check(config);
  return Renderer(lit_scene, camera, config).run(progress);
}

}  // namespace relumbre
