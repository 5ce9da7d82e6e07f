#include "relumbre/image/thin_lens.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"

namespace relumbre {

namespace {

constexpr double kMetresPerMillimetre = 1e-3;
constexpr int kMostBlades = 64;

void require_positive(const char* name, double value, const char* unit) {
  if (value > 0 && std::isfinite(value)) return;
  throw ValueError(fmt::format("lens: {} is {}{}; it must be above 0", name, value, unit));
}

bool is_surface(float depth) { return depth > 0 && std::isfinite(depth); }

}  // namespace

void ThinLens::check() const {
  require_positive("the focal length", focal_length_mm, " mm");
  require_positive("the f-number", f_number, "");
  require_positive("the focus distance", focus_distance_m, " m");
  require_positive("the sensor's width", sensor_width_mm, " mm");
  if (!(focus_distance_m > focal_length_mm * kMetresPerMillimetre)) {
    throw ValueError(
        fmt::format("lens: a focus distance of {} m is not beyond the focal length of {} mm",
                    focus_distance_m, focal_length_mm));
  }
}

double ThinLens::coc_at_infinity_pixels(std::size_t width_pixels) const {
  const double focus_mm = focus_distance_m / kMetresPerMillimetre;
  const double on_sensor_mm =
      focal_length_mm * focal_length_mm / (f_number * (focus_mm - focal_length_mm));
  return on_sensor_mm * static_cast<double>(width_pixels) / sensor_width_mm;
}

double ThinLens::signed_coc_diameter_pixels(double z, std::size_t width_pixels) const {
  return coc_at_infinity_pixels(width_pixels) * (1 - focus_distance_m / z);
}

double ThinLens::coc_diameter_pixels(double z, std::size_t width_pixels) const {
  return std::abs(signed_coc_diameter_pixels(z, width_pixels));
}

// Seen through a lens point at offset l, a point at depth z moves by l (1/z_f − 1/z) in tangents
// against the plane in focus: at infinity by l / z_f.
double ThinLens::opening_diameter_m(double pixels_per_tangent, std::size_t width_pixels) const {
  return coc_at_infinity_pixels(width_pixels) * focus_distance_m / pixels_per_tangent;
}

void Aperture::check() const {
  if (blades != 0 && (blades < 3 || blades > kMostBlades)) {
    throw ValueError(
        fmt::format("lens: {} blades; 0 (a disc) and 3 to {} are possible", blades, kMostBlades));
  }
  if (!std::isfinite(rotation_deg)) throw ValueError("lens: the blades' rotation is not finite");
}

double Aperture::open_fraction() const {
  if (blades == 0) return 1;
  return blades * std::sin(2 * std::numbers::pi / blades) / (2 * std::numbers::pi);
}

Vec2f Aperture::point(float u, float v) const {
  if (blades == 0) return square_to_disc(u, v);
  // One isosceles triangle a blade, apex at the centre; u picks it and is then used again.
  const double along = static_cast<double>(u) * blades;
  const double sector = std::min(std::floor(along), static_cast<double>(blades - 1));
  const double step = 2 * std::numbers::pi / blades;
  const double from = rotation_deg * std::numbers::pi / 180 + sector * step;
  const Vec2f weight = square_to_triangle(static_cast<float>(along - sector), v);
  const Vec2f a{static_cast<float>(std::cos(from)), static_cast<float>(std::sin(from))};
  const Vec2f b{static_cast<float>(std::cos(from + step)),
                static_cast<float>(std::sin(from + step))};
  return a * weight.x + b * weight.y;
}

double focus_on_pixel(std::span<const float> depth, std::size_t width, std::size_t height,
                      std::size_t x, std::size_t y) {
  if (width == 0 || depth.size() % width != 0 || depth.size() / width != height) {
    throw ShapeError(
        fmt::format("focus: {} depths for {} x {} pixels", depth.size(), width, height));
  }
  if (x >= width || y >= height) {
    throw ValueError(
        fmt::format("focus: pixel {},{} lies outside of {} x {} pixels", x, y, width, height));
  }
  const float z = depth[y * width + x];
  if (!is_surface(z)) throw ValueError(fmt::format("focus: nothing is at pixel {},{}", x, y));
  return static_cast<double>(z);
}

double focus_on_nearest(std::span<const float> depth) {
  float nearest = std::numeric_limits<float>::infinity();
  for (const float z : depth) {
    if (is_surface(z)) nearest = std::min(nearest, z);
  }
  if (!is_surface(nearest)) throw ValueError("focus: nothing is in view");
  return static_cast<double>(nearest);
}

}  // namespace relumbre
