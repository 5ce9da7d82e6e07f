#include "relumbre/render/view_tiles.h"

#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/render/primary_hits.h"

namespace relumbre {

namespace {

constexpr std::size_t kMaxPixels = std::size_t{1} << 28;
constexpr std::uint32_t kMaxLightSamples = 1U << 14;

}  // namespace

void check_picture_size(std::size_t width, std::size_t height) {
  const bool too_many = width != 0 && height > kMaxPixels / width;
  if (width == 0 || height == 0 || too_many) {
    throw ValueError(fmt::format("view: an image of {} by {} pixels; 1 to 2^28 in all are possible",
                                 width, height));
  }
}

void check_samples(std::uint32_t samples, std::uint32_t most) {
  if (samples != 0 && samples <= most) return;
  throw ValueError(fmt::format("view: {} samples; 1 to {} are possible", samples, most));
}

void check_view(const ViewConfig& config, std::uint32_t max_samples) {
  check_picture_size(config.width, config.height);
  check_samples(config.samples, max_samples);
  check_samples(config.light_samples, kMaxLightSamples);
}

void set_pixel(Image& image, std::size_t pixel, const std::array<const char*, 3>& channels,
               const Vec3f& value) {
  for (std::size_t c = 0; c < 3; ++c) image.channel(channels[c])[pixel] = value[c];
}

void render_center_channels(const LitScene& in, const CameraRays& camera, const ViewTile& tile,
                            Image& image) {
  std::vector<Ray> rays(tile.pixels());
  std::vector<Hit> hits(tile.pixels());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t p = tile.pixel(i);
    rays[i] = camera.through(static_cast<float>(p % tile.image_width) + 0.5F,
                             static_cast<float>(p / tile.image_width) + 0.5F);
  }
  trace_primary(in.scene, in.rays, rays, hits);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const std::size_t p = tile.pixel(i);
    image.channel("Z")[p] = hits[i].t;
    if (!hits[i]) continue;
    const Surface surface = surface_at(in.scene, hits[i]);
    set_pixel(image, p, {"N.X", "N.Y", "N.Z"}, surface.normal);
    set_pixel(image, p, {"albedo.R", "albedo.G", "albedo.B"}, surface.reflectance);
  }
}

}  // namespace relumbre
