#include "relumbre/render/lens_view.h"

#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/render/camera_rays.h"
#include "relumbre/render/lens_samples.h"
#include "relumbre/render/primary_hits.h"
#include "relumbre/render/view_shader.h"
#include "relumbre/render/view_tiles.h"

namespace relumbre {

namespace {

constexpr std::uint32_t kMaxSamples = 1U << 16;
constexpr std::size_t kTileSide = 8;

void check(const LensViewConfig& config) {
  check_view(config.view, kMaxSamples);
  if (config.view.layers != 1) {
    throw ValueError(fmt::format("view: {} layers; a lens has one", config.view.layers));
  }
  config.lens.check();
  config.aperture.check();
}

class LensRenderer {
 public:
  LensRenderer(const LitScene& in, const Camera& camera, const LensViewConfig& config)
      : in_(in),
        config_(config.view),
        camera_(camera, config.view.width, config.view.height),
        samples_(config.aperture, config.view.samples, config.view.seed),
        shader_(in, config.view),
        focus_(static_cast<float>(config.lens.focus_distance_m)),
        radius_(static_cast<float>(
            config.lens.opening_diameter_m(camera_.pixels_per_tangent(), config.view.width) / 2)),
        image_(config.view.width, config.view.height, channel_names()) {}

  Image run(Progress& progress) && {
    for_each_tile(config_.width, config_.height, kTileSide, "lens", progress,
                  [&](const ViewTile& tile) {
                    render_center_channels(in_, camera_, tile, image_);
                    for (std::size_t i = 0; i < tile.pixels(); ++i) render_pixel(tile.pixel(i));
                  });
    return std::move(image_);
  }

 private:
  static std::vector<std::string> channel_names() {
    return {"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"};
  }

  [[nodiscard]] Ray ray(std::size_t pixel, const LensSample& sample) const {
    return camera_.through_lens(static_cast<float>(pixel % config_.width) + 0.5F + sample.pixel.x,
                                static_cast<float>(pixel / config_.width) + 0.5F + sample.pixel.y,
                                sample.lens * radius_, focus_);
  }

  void render_pixel(std::size_t pixel) {
    const std::span<const LensSample> samples = samples_.of_pixel(pixel);
    std::vector<Hit> hits(samples.size());
    for (std::size_t first = 0; first < samples.size(); first += RayPacket::kSize) {
      const std::size_t lanes = std::min(RayPacket::kSize, samples.size() - first);
      trace(pixel, samples.subspan(first, lanes), std::span(hits).subspan(first, lanes));
    }
    std::vector<SampleId> ids(samples.size());
    for (std::size_t s = 0; s < ids.size(); ++s) ids[s] = {pixel, samples[s].index};
    std::vector<Rgb> color(samples.size());
    shader_.shade(hits, ids, color);
    set_mean(pixel, samples, hits, color);
  }

  /// At most a packet's worth of rays.
  void trace(std::size_t pixel, std::span<const LensSample> samples, std::span<Hit> hits) const {
    RayPacket packet{};
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Ray r = ray(pixel, samples[i]);
      for (std::size_t c = 0; c < 3; ++c) {
        packet.origin[c][i] = r.origin[c];
        packet.direction[c][i] = r.direction[c];
      }
      packet.t_min[i] = r.t_min;
      packet.t_max[i] = r.t_max;
    }
    HitPacket met;
    trace_primary(in_.scene, in_.rays, packet, met, samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (met.triangle[i] == kNone) continue;
      hits[i] = {met.triangle[i], met.t[i], met.u[i], met.v[i], met.back[i] != 0};
    }
  }

  void set_mean(std::size_t pixel, std::span<const LensSample> samples, std::span<const Hit> hits,
                std::span<const Rgb> color) {
    Vec3d sum;
    std::size_t covered = 0;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      sum += Vec3d(hits[s] ? color[s] : shader_.background(ray(pixel, samples[s]).direction));
      covered += hits[s] ? 1 : 0;
    }
    const auto count = static_cast<double>(samples.size());
    set_pixel(image_, pixel, {"R", "G", "B"}, Rgb(sum / count));
    image_.channel("A")[pixel] = static_cast<float>(static_cast<double>(covered) / count);
  }

  const LitScene& in_;
  const ViewConfig& config_;
  CameraRays camera_;
  LensSamples samples_;
  ViewShader shader_;
  float focus_, radius_;
  Image image_;
};

}  // namespace

Image render_lens_view(const LitScene& lit_scene, const Camera& camera,
                       const LensViewConfig& config, Progress& progress) {
  check(config);
  return LensRenderer(lit_scene, camera, config).run(progress);
}

std::vector<float> pinhole_depth(const Scene& scene, const RayScene& rays, const Camera& camera,
                                 std::size_t width, std::size_t height) {
  check_picture_size(width, height);
  const CameraRays through(camera, width, height);
  std::vector<float> depth(width * height);
  parallel_for(0, height, 4, [&](std::size_t y) {
    std::vector<Ray> row(width);
    std::vector<Hit> hits(width);
    for (std::size_t x = 0; x < width; ++x) {
      row[x] = through.through(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
    }
    trace_primary(scene, rays, row, hits);
    for (std::size_t x = 0; x < width; ++x) depth[y * width + x] = hits[x].t;
  });
  return depth;
}

}  // namespace relumbre
