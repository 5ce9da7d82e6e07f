/// A picture with depth: what depth of field is computed from.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "relumbre/image/image.h"

namespace relumbre {

/// Linear colour, premultiplied by alpha.
struct Rgba {
  float r = 0, g = 0, b = 0, a = 0;
  friend bool operator==(const Rgba&, const Rgba&) = default;
};

/// One surface a pixel, row-major, row 0 at the top.
struct PictureLayer {
  std::vector<Rgba> color;
  std::vector<float> depth;  ///< planar, metres, above 0; +inf: nothing there
};

/// What a pinhole camera sees, and perhaps what lies behind that.
struct DepthPicture {
  std::size_t width = 0, height = 0;
  PictureLayer front;
  /// Empty, or as large as `front`: the first surface behind it that faces the camera. A depth of
  /// 0: it is not known what lies behind.
  PictureLayer behind = {};

  [[nodiscard]] std::size_t pixels() const { return width * height; }
  [[nodiscard]] bool has_behind() const { return !behind.color.empty(); }
  /// Alpha is 1 wherever there is something.
  [[nodiscard]] bool opaque() const;
  /// Throws ShapeError if the planes do not fit the size, ValueError naming the first pixel whose
  /// depth is NaN, 0 or negative, or whose colour is not finite.
  void check() const;
};

/// Where colour and depth are in an image, and what they mean.
struct DepthPictureConfig {
  /// Colour's prefix: "" for R, G, B; "ViewLayer.Combined." for what Blender writes. By itself
  /// (kFind), R, G, B; else the one that ends in "Combined.", of several the only one whose layer
  /// has a depth; else the first with R, G and B.
  std::string color = kFind;
  /// The depth channel: by itself, of `Z` and those that end in Depth.Z, depth.Z, Depth.V or
  /// depth.V the first of the colour's own layer ("ViewLayer." of the one above), or else of a
  /// layer without a colour. Colour and depth of two view layers are only taken together if both
  /// are asked for.
  std::string depth = kFind;
  /// Depth is the distance along the ray, not along the camera's axis. It is converted with
  /// `pixels_per_tangent`: the length in pixels of a metre at a depth of one metre.
  bool radial = false;
  double pixels_per_tangent = 0;
  /// Colour is not multiplied by alpha yet.
  bool straight_alpha = false;

  static constexpr const char* kFind = "?";
};

/// Reads colour, depth and, where the image has `layer1.R` … `layer1.Z`, what lies behind.
/// No data: a depth of 0, of +inf, or of 1e9 and more (renderers differ) becomes +inf; a
/// `layer1.Z` of 0 stays 0. An image without alpha is opaque. Throws ValueError naming the channel
/// that is missing, and the channels that are there, or the layers between which it cannot choose;
/// for NaN or negative depth, naming the pixel.
DepthPicture depth_picture(const Image& image, const DepthPictureConfig& config = {});

/// R, G, B, A of colours.
Image image_of(const std::vector<Rgba>& color, std::size_t width, std::size_t height);

}  // namespace relumbre
