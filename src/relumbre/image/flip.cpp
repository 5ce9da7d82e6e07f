#include "relumbre/image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/image/flip_filters.h"
#include "relumbre/image/srgb.h"

namespace relumbre {

namespace {

// Andersson et al. 2020, §4.1.3 and §4.2: exponents, and where errors are bent.
constexpr float kColorExponent = 0.7F, kFeatureExponent = 0.5F;
constexpr float kBendAt = 0.4F, kBentTo = 0.95F;

// Linear R, G, B to X/Xn, Y/Yn, Z/Zn: each row of the XYZ matrix is divided by its sum, the white
// point D65.
constexpr Vec3f over_sum(double r, double g, double b) {
  return Vec3f(Vec3d(r, g, b) / (r + g + b));
}
constexpr std::array<Vec3f, 3> kXyzOverWhite = {over_sum(10135552, 8788810, 4435075),
                                                over_sum(2613072, 8788810, 887015),
                                                over_sum(1425312, 8788810, 70074185)};
// The inverse of the matrix above: from X/Xn, Y/Yn, Z/Zn to linear R, G, B.
constexpr std::array<Vec3f, 3> kRgbOfXyz = {Vec3f{3.0803420F, -1.5373989F, -0.5429431F},
                                            Vec3f{-0.9211784F, 1.8759301F, 0.0452484F},
                                            Vec3f{0.0528813F, -0.2040112F, 1.1511299F}};

Vec3f times(const std::array<Vec3f, 3>& matrix, const Vec3f& v) {
  return {dot(matrix[0], v), dot(matrix[1], v), dot(matrix[2], v)};
}

/// NaN stays NaN.
float clamp_unit(float value) { return value < 0 ? 0.0F : value > 1 ? 1.0F : value; }

/// The linear counterpart of L*a*b*.
Vec3f ycxcz(const Rgb& linear) {
  const Vec3f xyz = times(kXyzOverWhite, linear);
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

Rgb linear_rgb(const Vec3f& ycxcz) {
  const float y = (ycxcz.x + 16) / 116;
  return times(kRgbOfXyz, {y + ycxcz.y / 500, y, y - ycxcz.z / 200});
}

float lab_curve(float t) {
  constexpr float delta = 6.0F / 29;
  return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0F / 29;
}

/// L*a*b* in which what is dark is also less colourful (Hunt 1952).
Vec3f hunt_lab(const Rgb& linear) {
  const Vec3f xyz = times(kXyzOverWhite, linear);
  const float x = lab_curve(xyz.x), y = lab_curve(xyz.y), z = lab_curve(xyz.z);
  const float lightness = 116 * y - 16;
  return {lightness, 0.01F * lightness * 500 * (x - y), 0.01F * lightness * 200 * (y - z)};
}

/// Abasi et al. 2020.
float hyab(const Vec3f& a, const Vec3f& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// A colour distance to [0, 1]; `largest` is the distance that counts as 1, to the exponent.
float bent(float distance, float largest) {
  const float error = std::pow(distance, kColorExponent), bend = kBendAt * largest;
  if (error < bend) return kBentTo / bend * error;
  return clamp_unit(kBentTo + (error - bend) / (largest - bend) * (1 - kBentTo));
}

/// Planes of what one image looks like.
struct Seen {
  FilterPlane y, cx, cz;  ///< filtered by contrast sensitivity
  FilterPlane edge_x, edge_y, point_x, point_y;
};

/// `linear(i)` gives pixel i in [0, 1], linear.
template <class Linear>
Seen look_at(const Image& image, const FlipFilters& filters, Linear&& linear) {
  const std::size_t width = image.width(), height = image.height();
  FilterPlane y(width, height), cx(width, height), cz(width, height);
  parallel_for(0, image.pixels(), 4096, [&](std::size_t i) {
    const Vec3f color = ycxcz(linear(i));
    y.values[i] = color.x, cx.values[i] = color.y, cz.values[i] = color.z;
  });
  Seen seen;
  seen.y = convolved(y, filters.achromatic, filters.achromatic);
  seen.cx = convolved(cx, filters.red_green, filters.red_green);
  seen.cz = convolved(cz, filters.blue_yellow[0], filters.blue_yellow[0]);
  const FilterPlane wide = convolved(cz, filters.blue_yellow[1], filters.blue_yellow[1]);
  for (std::size_t i = 0; i < wide.values.size(); ++i) seen.cz.values[i] += wide.values[i];

  for (float& v : y.values) v /= 116;  // the detectors' weights sum to 0: no need to add 16
  seen.edge_x = convolved(y, filters.edge, filters.smooth);
  seen.edge_y = convolved(y, filters.smooth, filters.edge);
  seen.point_x = convolved(y, filters.point, filters.smooth);
  seen.point_y = convolved(y, filters.smooth, filters.point);
  return seen;
}

float color_error(const Seen& a, const Seen& b, std::size_t i, float largest) {
  const auto color = [i](const Seen& seen) {
    const Rgb rgb = linear_rgb({seen.y.values[i], seen.cx.values[i], seen.cz.values[i]});
    return hunt_lab({clamp_unit(rgb.x), clamp_unit(rgb.y), clamp_unit(rgb.z)});
  };
  return bent(hyab(color(a), color(b)), largest);
}

float feature_error(const Seen& a, const Seen& b, std::size_t i) {
  const auto edge = [i](const Seen& s) {
    return std::hypot(s.edge_x.values[i], s.edge_y.values[i]);
  };
  const auto point = [i](const Seen& s) {
    return std::hypot(s.point_x.values[i], s.point_y.values[i]);
  };
  const float larger = std::max(std::abs(edge(a) - edge(b)), std::abs(point(a) - point(b)));
  return std::pow(larger * std::numbers::sqrt2_v<float> / 2, kFeatureExponent);
}

std::vector<float> difference(const Seen& a, const Seen& b) {
  const float largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kColorExponent);
  std::vector<float> error(a.y.values.size());
  parallel_for(0, error.size(), 4096, [&](std::size_t i) {
    error[i] = std::pow(color_error(a, b, i, largest), 1 - feature_error(a, b, i));
  });
  return error;
}

void check(const Image& a, const Image& b, const FlipConfig& config) {
  if (a.width() != b.width() || a.height() != b.height() || a.pixels() == 0) {
    throw ShapeError(fmt::format("cannot compare an image of {} x {} pixels with one of {} x {}",
                                 a.width(), a.height(), b.width(), b.height()));
  }
  if (!(config.pixels_per_degree >= 1 && config.pixels_per_degree <= 1000)) {
    throw ValueError(fmt::format("FLIP: {} pixels per degree; 1 to 1000 are possible",
                                 config.pixels_per_degree));
  }
  (void)a.rgb(0), (void)b.rgb(0);  // throw where a channel is missing
}

// The papers' tone curve: Narkowicz 2015, with its exposure of 0.6 taken into the coefficients.
//   t(x) = (k0 x² + k1 x) / (k3 x² + k4 x + k5), clamped to [0, 1]
constexpr float k0 = 0.6F * 0.6F * 2.51F, k1 = 0.6F * 0.03F;
constexpr float k3 = 0.6F * 0.6F * 2.43F, k4 = 0.6F * 0.59F, k5 = 0.14F;

float tone(float x) {
  if (x <= 0) return 0;
  if (x > 1e6F) return 1;  // where squares would overflow, the curve has long passed white
  return clamp_unit((k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5));
}

/// The x of tone(x) = shown: the positive root of a quadratic.
double inverse_tone(double shown) {
  const double a = double{k0} - double{k3} * shown;
  const double p = (double{k1} - double{k4} * shown) / a, q = -double{k5} * shown / a;
  return -p / 2 + std::sqrt(p * p / 4 - q);
}

/// As numpy's percentile(50): the mean of the middle two where there is no middle one.
double median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return static_cast<double>(*middle);
  const float below = *std::max_element(values.begin(), middle);
  return (static_cast<double>(*middle) + static_cast<double>(below)) / 2;
}

}  // namespace

double pixels_per_degree(double distance_m, double width_m, double width_px) {
  if (!(distance_m > 0 && width_m > 0 && width_px > 0)) {
    throw ValueError("FLIP: distance and width of the screen must be above 0");
  }
  return distance_m * (width_px / width_m) * std::numbers::pi / 180;
}

std::vector<float> flip_ldr(const Image& reference, const Image& test, const FlipConfig& config) {
  check(reference, test, config);
  const FlipFilters filters = flip_filters(config.pixels_per_degree);
  const auto look = [&](const Image& image) {
    return look_at(image, filters, [&](std::size_t i) {
      const Rgb c = image.rgb(i);
      return Rgb{srgb_decode(clamp_unit(c.x)), srgb_decode(clamp_unit(c.y)),
                 srgb_decode(clamp_unit(c.z))};
    });
  };
  return difference(look(reference), look(test));
}

ExposureRange flip_exposures(const Image& reference) {
  std::vector<float> luminances, positive;
  luminances.reserve(reference.pixels());
  for (std::size_t i = 0; i < reference.pixels(); ++i) {
    const float y = luminance(reference.rgb(i));
    if (!std::isfinite(y)) continue;
    luminances.push_back(y);
    if (y > 0) positive.push_back(y);
  }
  if (positive.empty()) return {};
  const auto brightest = static_cast<double>(*std::max_element(positive.begin(), positive.end()));
  double middle = median(luminances);
  if (!(middle > 0)) middle = median(positive);
  const double shown = inverse_tone(0.85);
  ExposureRange range{std::log2(shown / brightest), std::log2(shown / middle), 2};
  range.count =
      std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(range.stop - range.start)));
  return range;
}

HdrFlip flip_hdr(const Image& reference, const Image& test, const FlipConfig& config) {
  check(reference, test, config);
  const FlipFilters filters = flip_filters(config.pixels_per_degree);
  HdrFlip result{std::vector<float>(reference.pixels(), 0.0F), flip_exposures(reference)};
  const ExposureRange& range = result.exposures;
  for (std::size_t e = 0; e < range.count; ++e) {
    const double step = (range.stop - range.start) / static_cast<double>(range.count - 1);
    const auto scale = static_cast<float>(std::exp2(range.start + step * static_cast<double>(e)));
    const auto look = [&](const Image& image) {
      return look_at(image, filters, [&](std::size_t i) {
        const Rgb c = image.rgb(i) * scale;
        return Rgb{tone(c.x), tone(c.y), tone(c.z)};
      });
    };
    const std::vector<float> error = difference(look(reference), look(test));
    for (std::size_t i = 0; i < error.size(); ++i) {
      if (!(error[i] <= result.error[i])) result.error[i] = error[i];  // NaN is kept
    }
  }
  return result;
}

double mean_error(std::span<const float> error, std::span<const std::uint8_t> mask) {
  if (!mask.empty() && mask.size() != error.size()) {
    throw ShapeError(fmt::format("a mask of {} pixels for {} errors", mask.size(), error.size()));
  }
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    sum += static_cast<double>(error[i]);
    ++count;
  }
  return sum / static_cast<double>(count);
}

}  // namespace relumbre
