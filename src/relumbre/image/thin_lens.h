/// The thin lens: how far a point is out of focus, and what shape its blur has.
#pragma once

#include <cstddef>
#include <span>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// A camera lens in photographers' units. A point at planar depth z is imaged as a blur whose
/// diameter on the sensor is
///
///        f² (z − z_f)            f  focal length           N    f-number
///   c = ──────────────           z  depth of the point     z_f  depth of the plane in focus
///       z N (z_f − f)
///
/// and c · image width / sensor width in pixels. |c| falls to 0 at z_f, rises without bound towards
/// the lens, and tends to f² / (N (z_f − f)) at infinity. Source: Potmesil and Chakravarty 1981.
struct ThinLens {
  double focal_length_mm = 50;
  double f_number = 1.4;
  double focus_distance_m = 2;
  double sensor_width_mm = 36;

  /// Throws ValueError naming the value: anything not finite, a length or f-number not above 0, a
  /// focus at or inside the focal length.
  void check() const;

  /// Of an image `width_pixels` wide; `z` in metres, above 0, infinity allowed. Negative before the
  /// plane in focus, positive behind.
  [[nodiscard]] double signed_coc_diameter_pixels(double z, std::size_t width_pixels) const;
  /// Its absolute value.
  [[nodiscard]] double coc_diameter_pixels(double z, std::size_t width_pixels) const;
  /// That of a point at infinity: what the others are a multiple of.
  [[nodiscard]] double coc_at_infinity_pixels(std::size_t width_pixels) const;

  /// Diameter in metres of the opening that gives these blurs in a perspective view of which a
  /// metre at a depth of one metre is `pixels_per_tangent` pixels long. It is f / N where the view
  /// has the lens's own angle of view; the blur's size is what counts, so that a lens can be put on
  /// any picture.
  [[nodiscard]] double opening_diameter_m(double pixels_per_tangent,
                                          std::size_t width_pixels) const;
};

/// The opening's outline: a disc, or a regular polygon with its corners on the disc's rim.
struct Aperture {
  int blades = 0;           ///< 0: a disc; otherwise at least 3
  double rotation_deg = 0;  ///< of the first corner from +x, counter-clockwise in the picture

  /// Throws ValueError: 1, 2, fewer than 0 or more than 64 blades, a rotation that is not finite.
  void check() const;

  /// Fraction of the disc that is open.
  [[nodiscard]] double open_fraction() const;
  /// The unit square to the opening within the unit disc (y up), equal-area. What is behind the
  /// plane in focus is blurred by this shape, what is before it by the shape turned by half a turn.
  [[nodiscard]] Vec2f point(float u, float v) const;
};

/// Depth of the surface at pixel (x, y), to focus on. `depth`: width · height, row 0 at the top;
/// infinity, NaN, 0 and below mean that nothing is there. Throws ValueError naming the pixel if
/// that is so or it lies outside the image, ShapeError if the sizes disagree.
double focus_on_pixel(std::span<const float> depth, std::size_t width, std::size_t height,
                      std::size_t x, std::size_t y);

/// Depth of the nearest surface. Throws ValueError if nothing is there at all.
double focus_on_nearest(std::span<const float> depth);

}  // namespace relumbre
