#include "relumbre/render/lens_view.h"

#include <algorithm>
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
constexpr std::size_t kMaxTileSide = 512;

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
    for_each_tile(config_.width, config_.height, tile_side(), "lens", progress,
                  [&](const ViewTile& tile) {
                    render_center_channels(in_, camera_, tile, image_);
                    const std::size_t together = pixels_together();
                    for (std::size_t i = 0; i < tile.pixels(); i += together)
                      render_pixels(tile, i, std::min(together, tile.pixels() - i));
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

  /// Pixels whose rays are traced in one call, as many as the tracer wants.
  [[nodiscard]] std::size_t pixels_together() const {
    if (!in_.rays.wants_long_batches()) return 1;
    return std::max<std::size_t>(1, in_.rays.preferred_batch() / config_.samples);
  }
  [[nodiscard]] std::size_t tile_side() const {
    std::size_t side = kTileSide;
    while (side * side < pixels_together() && side < kMaxTileSide) side *= 2;
    return side;
  }

  /// Pixels [first, first + count) of a tile.
  void render_pixels(const ViewTile& tile, std::size_t first, std::size_t count) {
    const std::size_t each = config_.samples;
    std::vector<Ray> rays;
    std::vector<SampleId> ids;
    rays.reserve(count * each), ids.reserve(count * each);
    for (std::size_t i = first; i < first + count; ++i) {
      const std::size_t pixel = tile.pixel(i);
      for (const LensSample& sample : samples_.of_pixel(pixel)) {
        rays.push_back(ray(pixel, sample));
        ids.push_back({pixel, sample.index});
      }
    }
    std::vector<Hit> hits(rays.size());
    trace(rays, hits);
    std::vector<Rgb> color(rays.size());
    shader_.shade(hits, ids, color);
    for (std::size_t i = 0; i < count; ++i) {
      set_mean(tile.pixel(first + i), std::span(rays).subspan(i * each, each),
               std::span(hits).subspan(i * each, each), std::span(color).subspan(i * each, each));
    }
  }

  void trace(std::span<const Ray> rays, std::span<Hit> hits) const {
    if (in_.rays.wants_long_batches()) return trace_primary(in_.scene, in_.rays, rays, hits);
    for (std::size_t first = 0; first < rays.size(); first += RayPacket::kSize) {
      const std::size_t lanes = std::min(RayPacket::kSize, rays.size() - first);
      trace_packet(rays.subspan(first, lanes), hits.subspan(first, lanes));
    }
  }

  /// At most a packet's worth of rays.
  void trace_packet(std::span<const Ray> rays, std::span<Hit> hits) const {
    RayPacket packet{};
    for (std::size_t i = 0; i < rays.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        packet.origin[c][i] = rays[i].origin[c];
        packet.direction[c][i] = rays[i].direction[c];
      }
      packet.t_min[i] = rays[i].t_min;
      packet.t_max[i] = rays[i].t_max;
    }
    HitPacket met;
    trace_primary(in_.scene, in_.rays, packet, met, rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (met.triangle[i] == kNone) continue;
      hits[i] = {met.triangle[i], met.t[i], met.u[i], met.v[i], met.back[i] != 0};
    }
  }

  void set_mean(std::size_t pixel, std::span<const Ray> rays, std::span<const Hit> hits,
                std::span<const Rgb> color) {
    Vec3d sum;
    std::size_t covered = 0;
    for (std::size_t s = 0; s < rays.size(); ++s) {
      sum += Vec3d(hits[s] ? color[s] : shader_.background(rays[s].direction));
      covered += hits[s] ? 1 : 0;
    }
    const auto count = static_cast<double>(rays.size());
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
  // Rows that are traced in one call.
  const std::size_t together =
      rays.wants_long_batches() ? std::max<std::size_t>(1, rays.preferred_batch() / width) : 1;
  parallel_chunks(0, height, together, [&](std::size_t first, std::size_t last) {
    std::vector<Ray> primary((last - first) * width);
    std::vector<Hit> hits(primary.size());
    for (std::size_t i = 0; i < primary.size(); ++i) {
      primary[i] = through.through(static_cast<float>(i % width) + 0.5F,
                                   static_cast<float>(first + i / width) + 0.5F);
    }
    trace_primary(scene, rays, primary, hits);
    for (std::size_t i = 0; i < hits.size(); ++i) depth[first * width + i] = hits[i].t;
  });
  return depth;
}

}  // namespace relumbre
