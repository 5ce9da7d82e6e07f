/// A picture cut into tiles that are rendered in parallel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "relumbre/base/parallel.h"
#include "relumbre/base/progress.h"
#include "relumbre/render/camera_rays.h"
#include "relumbre/render/view.h"

namespace relumbre {

/// Pixels [x0, x1) × [y0, y1).
struct ViewTile {
  std::size_t x0, y0, x1, y1;
  std::size_t image_width;

  [[nodiscard]] std::size_t width() const { return x1 - x0; }
  [[nodiscard]] std::size_t pixels() const { return width() * (y1 - y0); }
  /// The image's pixel that is the tile's pixel i, row by row.
  [[nodiscard]] std::size_t pixel(std::size_t i) const {
    return (y0 + i / width()) * image_width + x0 + i % width();
  }
};

/// Calls body(tile) for every tile, and tells `progress`, in pixels. Throws Cancelled.
template <class Body>
void for_each_tile(std::size_t width, std::size_t height, std::size_t side, std::string_view stage,
                   Progress& progress, Body&& body) {
  const std::size_t columns = (width + side - 1) / side, rows = (height + side - 1) / side;
  progress.begin(stage, width * height);
  parallel_for(0, columns * rows, 1, [&](std::size_t i) {
    progress.check();
    const std::size_t x = i % columns * side, y = i / columns * side;
    const ViewTile tile{x, y, std::min(x + side, width), std::min(y + side, height), width};
    body(tile);
    progress.advance(tile.pixels());
  });
}

/// Sets three planes of one pixel.
void set_pixel(Image& image, std::size_t pixel, const std::array<const char*, 3>& channels,
               const Vec3f& value);

/// Throw ValueError for what is out of range: see render_view.
void check_picture_size(std::size_t width, std::size_t height);
void check_samples(std::uint32_t samples, std::uint32_t most);
void check_view(const ViewConfig& config, std::uint32_t max_samples);

/// Adds Z, N.X N.Y N.Z and albedo.R .G .B of the surfaces on the rays through the centres of a
/// tile's pixels to an image that has these channels.
void render_center_channels(const LitScene& in, const CameraRays& camera, const ViewTile& tile,
                            Image& image);

/// A uniform number to [-1, 1] with the density of a tent: where in the pixels around it a sample
/// falls.
inline float tent(float u) {
  return u < 0.5F ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(std::max(0.0F, 2 - 2 * u));
}

}  // namespace relumbre
