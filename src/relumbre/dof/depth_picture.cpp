#include "relumbre/dof/depth_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/dof/picture_channels.h"

namespace relumbre {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Blender writes 1e10, others 1e30 or the largest half where there is nothing.
constexpr float kFar = 1e9F;

[[noreturn]] void throw_depth(float z, std::size_t pixel, std::size_t width) {
  throw ValueError(
      fmt::format("depth {} at pixel {},{}: it must be above 0", z, pixel % width, pixel / width));
}

/// `zero`: what a depth of 0 means.
float checked_depth(float z, std::size_t pixel, std::size_t width, float zero) {
  if (std::isnan(z) || z < 0) throw_depth(z, pixel, width);
  if (z == 0) return zero;
  return z >= kFar ? kInfinity : z;
}

/// Distances along rays to distances along the camera's axis.
void make_planar(PictureLayer& layer, std::size_t width, std::size_t height,
                 double pixels_per_tangent) {
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const double dx = (static_cast<double>(x) + 0.5 - static_cast<double>(width) / 2);
      const double dy = (static_cast<double>(y) + 0.5 - static_cast<double>(height) / 2);
      const double slant = std::hypot(1.0, dx / pixels_per_tangent, dy / pixels_per_tangent);
      float& z = layer.depth[y * width + x];
      z = static_cast<float>(static_cast<double>(z) / slant);
    }
  }
}

PictureLayer read_layer(const Image& image, const std::string& color, const std::string& depth,
                        bool straight_alpha, float zero) {
  const auto r = image.channel(color + "R"), g = image.channel(color + "G"),
             b = image.channel(color + "B"), z = image.channel(depth);
  std::optional<std::span<const float>> a;
  if (image.has(color + "A")) a = image.channel(color + "A");
  PictureLayer layer;
  layer.color.reserve(image.pixels());
  layer.depth.reserve(image.pixels());
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float alpha = a ? (*a)[i] : 1;
    const float scale = straight_alpha ? alpha : 1;
    layer.color.push_back({r[i] * scale, g[i] * scale, b[i] * scale, alpha});
    layer.depth.push_back(checked_depth(z[i], i, image.width(), zero));
  }
  return layer;
}

void check_layer(const PictureLayer& layer, std::size_t width, std::size_t height,
                 bool may_be_unknown) {
  if (layer.color.size() != width * height || layer.depth.size() != width * height) {
    throw ShapeError(fmt::format("picture of {} × {}: {} colours, {} depths", width, height,
                                 layer.color.size(), layer.depth.size()));
  }
  for (std::size_t i = 0; i < layer.color.size(); ++i) {
    const Rgba& c = layer.color[i];
    if (!std::isfinite(c.r) || !std::isfinite(c.g) || !std::isfinite(c.b) || !std::isfinite(c.a)) {
      throw ValueError(fmt::format("colour at pixel {},{} is not finite", i % width, i / width));
    }
    const float z = layer.depth[i];
    if (!(z > 0 || (may_be_unknown && z == 0))) throw_depth(z, i, width);
  }
}

}  // namespace

void DepthPicture::check() const {
  if (width == 0 || height == 0) {
    throw ShapeError(fmt::format("picture of {} × {}: it has no pixels", width, height));
  }
  check_layer(front, width, height, false);
  if (has_behind()) check_layer(behind, width, height, true);
}

bool DepthPicture::opaque() const {
  const auto solid = [](const Rgba& c) { return c.a == 1; };
  if (!std::ranges::all_of(front.color, solid)) return false;
  for (std::size_t i = 0; i < behind.color.size(); ++i)
    if (behind.depth[i] > 0 && !solid(behind.color[i])) return false;
  return true;
}

DepthPicture depth_picture(const Image& image, const DepthPictureConfig& config) {
  if (config.radial && !(config.pixels_per_tangent > 0)) {
    throw ValueError("radial depth: the camera's angle of view is needed");
  }
  const auto [color, depth] = find_channels(image, config);
  DepthPicture picture;
  picture.width = image.width();
  picture.height = image.height();
  picture.front = read_layer(image, color, depth, config.straight_alpha, kInfinity);
  if (has_color(image, "layer1.") && image.has("layer1.Z")) {
    picture.behind = read_layer(image, "layer1.", "layer1.Z", config.straight_alpha, 0);
  }
  if (config.radial) {
    make_planar(picture.front, picture.width, picture.height, config.pixels_per_tangent);
    if (picture.has_behind())
      make_planar(picture.behind, picture.width, picture.height, config.pixels_per_tangent);
  }
  picture.check();
  return picture;
}

Image image_of(const std::vector<Rgba>& color, std::size_t width, std::size_t height) {
  const std::string names[] = {"R", "G", "B", "A"};
  Image image(width, height, names);
  const auto r = image.channel("R"), g = image.channel("G"), b = image.channel("B"),
             a = image.channel("A");
  for (std::size_t i = 0; i < color.size(); ++i) {
    r[i] = color[i].r, g[i] = color[i].g, b[i] = color[i].b, a[i] = color[i].a;
  }
  return image;
}

}  // namespace relumbre
