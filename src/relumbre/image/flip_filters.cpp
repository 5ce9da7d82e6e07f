#include "relumbre/image/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

/// Contrast sensitivity as a sum of Gaussians a √(π/b) exp(−π² d² / b), d in degrees.
struct Sensitivity {
  double a, b;
};
constexpr Sensitivity kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053};
constexpr std::array<Sensitivity, 2> kBlueYellow{{{34.1, 0.04}, {13.5, 0.025}}};
constexpr double kWidest = 0.04;
constexpr double kDetectorWidth = 0.082;  ///< degrees from peak to trough of an edge detector

template <class Weight>
std::vector<double> kernel(int radius, Weight&& weight) {
  std::vector<double> values;
  for (int i = -radius; i <= radius; ++i) values.push_back(weight(i));
  return values;
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double v : values) total += v;
  return total;
}

FilterKernel scaled(const std::vector<double>& values, double factor) {
  FilterKernel result;
  for (const double v : values) result.push_back(static_cast<float>(v * factor));
  return result;
}

std::vector<double> gaussian(const Sensitivity& s, int radius, double pixels_per_degree) {
  return kernel(radius, [&](int i) {
    const double degrees = i / pixels_per_degree;
    return std::exp(-std::numbers::pi * std::numbers::pi * degrees * degrees / s.b);
  });
}

/// Positive weights sum to 1 and negative ones to −1.
FilterKernel balanced(std::vector<double> values) {
  double positive = 0, negative = 0;
  for (const double v : values) (v > 0 ? positive : negative) += std::abs(v);
  for (double& v : values) v /= v > 0 ? positive : negative;
  return scaled(values, 1);
}

/// Two Gaussians whose products with themselves add up to one filter of sum 1.
std::array<FilterKernel, 2> blue_yellow(int radius, double pixels_per_degree) {
  std::array<std::vector<double>, 2> shape;
  std::array<double, 2> peak{};
  double total = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    shape[k] = gaussian(kBlueYellow[k], radius, pixels_per_degree);
    peak[k] = kBlueYellow[k].a * std::sqrt(std::numbers::pi / kBlueYellow[k].b);
    total += peak[k] * sum(shape[k]) * sum(shape[k]);
  }
  return {scaled(shape[0], std::sqrt(peak[0] / total)),
          scaled(shape[1], std::sqrt(peak[1] / total))};
}

std::size_t nearest(std::ptrdiff_t i, std::size_t size) {
  return static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(size) - 1));
}

/// out[x] += Σ kernel[k] · padded[x + k].
void add_weighted(std::span<float> out, float weight, const float* in) {
  for (std::size_t x = 0; x < out.size(); ++x) out[x] += weight * in[x];
}

FilterPlane along_rows(const FilterPlane& plane, const FilterKernel& kernel) {
  const std::size_t radius = kernel.size() / 2, width = plane.width;
  FilterPlane result(width, plane.height);
  parallel_for(0, plane.height, 8, [&](std::size_t y) {
    const float* row = plane.values.data() + y * width;
    std::vector<float> padded(width + 2 * radius, row[0]);
    std::copy_n(row, width, padded.begin() + static_cast<std::ptrdiff_t>(radius));
    std::fill(padded.end() - static_cast<std::ptrdiff_t>(radius), padded.end(), row[width - 1]);
    const std::span<float> out(result.values.data() + y * width, width);
    for (std::size_t k = 0; k < kernel.size(); ++k) add_weighted(out, kernel[k], &padded[k]);
  });
  return result;
}

FilterPlane along_columns(const FilterPlane& plane, const FilterKernel& kernel) {
  const auto radius = static_cast<std::ptrdiff_t>(kernel.size() / 2);
  FilterPlane result(plane.width, plane.height);
  parallel_for(0, plane.height, 8, [&](std::size_t y) {
    const std::span<float> out(result.values.data() + y * plane.width, plane.width);
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const auto from = static_cast<std::ptrdiff_t>(y + k) - radius;
      add_weighted(out, kernel[k], plane.values.data() + nearest(from, plane.height) * plane.width);
    }
  });
  return result;
}

}  // namespace

FlipFilters flip_filters(double pixels_per_degree) {
  const double spread = std::sqrt(kWidest / (2 * std::numbers::pi * std::numbers::pi));
  const int radius = static_cast<int>(std::ceil(3 * spread * pixels_per_degree));
  const double deviation = 0.5 * kDetectorWidth * pixels_per_degree;
  const int reach = static_cast<int>(std::ceil(3 * deviation));
  const auto bell = [&](int i) { return std::exp(-i * i / (2 * deviation * deviation)); };
  const std::vector<double> achromatic = gaussian(kAchromatic, radius, pixels_per_degree);
  const std::vector<double> red_green = gaussian(kRedGreen, radius, pixels_per_degree);
  const std::vector<double> smooth = kernel(reach, bell);

  FlipFilters filters;
  filters.achromatic = scaled(achromatic, 1 / sum(achromatic));
  filters.red_green = scaled(red_green, 1 / sum(red_green));
  filters.blue_yellow = blue_yellow(radius, pixels_per_degree);
  filters.edge = balanced(kernel(reach, [&](int i) { return -i * bell(i); }));
  filters.point = balanced(
      kernel(reach, [&](int i) { return (i * i / (deviation * deviation) - 1) * bell(i); }));
  filters.smooth = scaled(smooth, 1 / sum(smooth));
  return filters;
}

FilterPlane convolved(const FilterPlane& plane, const FilterKernel& horizontal,
                      const FilterKernel& vertical) {
  return along_columns(along_rows(plane, horizontal), vertical);
}

}  // namespace relumbre
