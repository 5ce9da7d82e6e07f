#include "relumbre/image/metrics.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

constexpr std::size_t kWindow = 11;
constexpr std::array<std::string_view, 3> kRgb = {"R", "G", "B"};

std::string shape_text(const Image& image) {
  return std::to_string(image.width()) + " x " + std::to_string(image.height());
}

void require_same_shape(const Image& a, const Image& b) {
  if (a.width() != b.width() || a.height() != b.height() || a.pixels() == 0) {
    throw ShapeError("cannot compare an image of " + shape_text(a) + " pixels with one of " +
                     shape_text(b));
  }
}

void require_mask(const Image& image, PixelMask mask) {
  if (mask.empty() || mask.size() == image.pixels()) return;
  throw ShapeError("a mask of " + std::to_string(mask.size()) + " pixels for an image of " +
                   shape_text(image));
}

bool counts(PixelMask mask, std::size_t pixel) { return mask.empty() || mask[pixel] != 0; }

void require_peak(double peak) {
  if (!(peak > 0) || !std::isfinite(peak)) throw ValueError("the peak value must be above 0");
}

std::array<double, kWindow> gaussian_weights() {
  constexpr double sigma = 1.5;
  std::array<double, kWindow> weights{};
  double sum = 0;
  for (std::size_t i = 0; i < kWindow; ++i) {
    const double d = static_cast<double>(i) - (kWindow - 1) / 2.0;
    sum += weights[i] = std::exp(-d * d / (2 * sigma * sigma));
  }
  for (double& w : weights) w /= sum;
  return weights;
}

using Plane = std::vector<double>;

/// Windowed sums of a, b, a², b² and ab at one place.
using Moments = std::array<double, 5>;

/// The vertical half of the separable window: moments of column x, rows y .. y + 10.
Moments column_moments(const Plane& a, const Plane& b, std::size_t width, std::size_t x,
                       std::size_t y, const std::array<double, kWindow>& weights) {
  Moments m{};
  for (std::size_t j = 0; j < kWindow; ++j) {
    const double p = a[(y + j) * width + x], q = b[(y + j) * width + x], w = weights[j];
    m[0] += w * p, m[1] += w * q, m[2] += w * p * p, m[3] += w * q * q, m[4] += w * p * q;
  }
  return m;
}

/// Wang et al. 2004, eq. 13.
double similarity(const Moments& m, double peak) {
  const double c1 = 0.01 * peak * 0.01 * peak, c2 = 0.03 * peak * 0.03 * peak;
  const double mean_product = m[0] * m[1], mean_squares = m[0] * m[0] + m[1] * m[1];
  const double covariance = m[4] - mean_product, variances = m[2] + m[3] - mean_squares;
  return (2 * mean_product + c1) * (2 * covariance + c2) / ((mean_squares + c1) * (variances + c2));
}

struct Sum {
  double value = 0;
  std::size_t count = 0;
};

/// The similarity over the windows whose upper row is y.
Sum row_similarity(const Plane& a, const Plane& b, std::size_t width, std::size_t y, double peak,
                   const std::array<double, kWindow>& weights, PixelMask mask) {
  std::vector<Moments> columns(width);
  for (std::size_t x = 0; x < width; ++x) columns[x] = column_moments(a, b, width, x, y, weights);
  const std::size_t middle = (y + kWindow / 2) * width + kWindow / 2;
  Sum sum;
  for (std::size_t x = 0; x + kWindow <= width; ++x) {
    if (!counts(mask, middle + x)) continue;
    Moments m{};
    for (std::size_t i = 0; i < kWindow; ++i) {
      for (std::size_t k = 0; k < m.size(); ++k) m[k] += weights[i] * columns[x + i][k];
    }
    sum.value += similarity(m, peak);
    ++sum.count;
  }
  return sum;
}

double plane_ssim(const Plane& a, const Plane& b, std::size_t width, double peak, PixelMask mask) {
  const std::array<double, kWindow> weights = gaussian_weights();
  const std::size_t rows = a.size() / width - kWindow + 1;
  std::vector<Sum> sums(rows);  // added in order, so that threads do not change the result
  parallel_for(0, rows, 8, [&](std::size_t y) {
    sums[y] = row_similarity(a, b, width, y, peak, weights, mask);
  });
  Sum all;
  for (const Sum& s : sums) all.value += s.value, all.count += s.count;
  return all.value / static_cast<double>(all.count);
}

Plane luminance_plane(const Image& image) {
  Plane plane(image.pixels());
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = luminance(Vec3d(image.rgb(i)));
  return plane;
}

Plane channel_plane(const Image& image, std::string_view name) {
  const std::span<const float> values = image.channel(name);
  return {values.begin(), values.end()};
}

double rgb_mean_ssim(const Image& a, const Image& b, double peak, PixelMask mask) {
  double sum = 0;
  for (const std::string_view c : kRgb) {
    sum += plane_ssim(channel_plane(a, c), channel_plane(b, c), a.width(), peak, mask);
  }
  return sum / 3;
}

bool holds_window(const Image& image) {
  return image.width() >= kWindow && image.height() >= kWindow;
}

}  // namespace

double mean_squared_error(const Image& a, const Image& b, PixelMask mask) {
  require_same_shape(a, b);
  require_mask(a, mask);
  double sum = 0;
  std::size_t count = 0;
  for (const std::string_view name : kRgb) {
    const std::span<const float> p = a.channel(name), q = b.channel(name);
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!counts(mask, i)) continue;
      const double d = static_cast<double>(p[i]) - static_cast<double>(q[i]);
      sum += d * d;
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

double psnr(const Image& a, const Image& b, double peak, PixelMask mask) {
  require_peak(peak);
  return 10 * std::log10(peak * peak / mean_squared_error(a, b, mask));
}

double ssim(const Image& a, const Image& b, double peak, SsimOf of, PixelMask mask) {
  require_peak(peak);
  require_same_shape(a, b);
  require_mask(a, mask);
  if (!holds_window(a)) {
    throw ShapeError("SSIM needs sides of at least 11 pixels, not " + shape_text(a));
  }
  if (of == SsimOf::kRgbMean) return rgb_mean_ssim(a, b, peak, mask);
  return plane_ssim(luminance_plane(a), luminance_plane(b), a.width(), peak, mask);
}

ImageComparison compare_images(const Image& a, const Image& b, PixelMask mask) {
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  ImageComparison result{mean_squared_error(a, b, mask), psnr(a, b, 1, mask), undefined, undefined};
  if (holds_window(a)) {
    result.ssim_luminance = ssim(a, b, 1, SsimOf::kLuminance, mask);
    result.ssim_rgb = ssim(a, b, 1, SsimOf::kRgbMean, mask);
  }
  return result;
}

ImageComparison compare_tone_mapped(const Image& reference, const Image& test,
                                    const ToneConfig& config, PixelMask mask) {
  require_same_shape(reference, test);
  ToneConfig shared = config;
  if (config.auto_exposure) shared.exposure_stops += auto_exposure_stops(reference);
  shared.auto_exposure = false;
  return compare_images(tone_mapped(reference, shared), tone_mapped(test, shared), mask);
}

Image difference_image(const Image& a, const Image& b) {
  require_same_shape(a, b);
  Image difference = rgb_image(a.width(), a.height());
  for (const std::string_view name : kRgb) {
    const std::span<const float> p = a.channel(name), q = b.channel(name);
    const std::span<float> d = difference.channel(name);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::abs(p[i] - q[i]);
  }
  return difference;
}

}  // namespace relumbre
