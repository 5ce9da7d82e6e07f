#include "relumbre/sat/box_filter.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/sat/pixel_filter.h"
#include "relumbre/sat/table_reader.h"

namespace relumbre {

namespace {

constexpr std::size_t kRowsPerTask = 4;

void check_radius(double radius) {
  if (radius >= 0 && radius <= kLargestRadius) return;
  throw ValueError(fmt::format("box filter of radius {}: it must be from 0 to 2^20", radius));
}

float check_radii(std::span<const float> radii, const SatLayout& layout) {
  if (radii.size() != layout.pixels())
    throw ShapeError(fmt::format("box filter with {} radii for {} x {} pixels", radii.size(),
                                 layout.width, layout.height));
  float largest = 0;
  for (const float r : radii) {
    check_radius(double{r});
    largest = std::max(largest, r);
  }
  return largest;
}

/// Calls radius_at(pixel) for the radius of each pixel.
template <class RadiusAt>
void filter_all(const SummedAreaTable& table, double largest, RadiusAt&& radius_at,
                const BorderRule& border, std::span<float> out) {
  const SatLayout& layout = table.layout();
  check_pixel_count(layout, out.size());
  if (out.empty()) return;
  if (is_fixed(table.kind()) &&
      covered_pixels(largest, layout.width, layout.height) > table.fixed_point().largest_box)
    throw ValueError(
        fmt::format("box filter of radius {} on a {} table made for boxes of {} pixels", largest,
                    sat_kind_name(table.kind()), table.fixed_point().largest_box));
  with_reader(table, [&](const auto& reader) {
    const PixelFilter filter(reader, border);
    parallel_for(0, layout.height, kRowsPerTask, [&](std::size_t y) {
      for (std::size_t x = 0; x < layout.width; ++x) {
        const std::size_t pixel = y * layout.width + x;
        const SatSums mean = filter.mean(x, y, radius_at(pixel));
        for (std::size_t c = 0; c < layout.channels; ++c)
          out[pixel * layout.channels + c] = static_cast<float>(mean[c]);
      }
    });
  });
}

SummedAreaTable table_for(const PixelView& image, double largest_radius,
                          const BoxFilterConfig& config) {
  SatConfig sat;
  sat.kind = config.kind;
  sat.range = config.range;
  sat.largest_box = covered_pixels(largest_radius, image.width, image.height);
  return SummedAreaTable::build(image.values, image.width, image.height, image.channels, sat);
}

}  // namespace

void box_filter(const SummedAreaTable& table, double radius, const BorderRule& border,
                std::span<float> out) {
  check_radius(radius);
  filter_all(
      table, radius, [radius](std::size_t) { return radius; }, border, out);
}

void box_filter(const SummedAreaTable& table, std::span<const float> radii,
                const BorderRule& border, std::span<float> out) {
  const float largest = check_radii(radii, table.layout());
  filter_all(
      table, double{largest}, [radii](std::size_t i) { return double{radii[i]}; }, border, out);
}

std::vector<float> box_filter(const PixelView& image, double radius,
                              const BoxFilterConfig& config) {
  check_radius(radius);
  std::vector<float> out(image.values.size());
  box_filter(table_for(image, radius, config), radius, config.border, out);
  return out;
}

std::vector<float> box_filter(const PixelView& image, std::span<const float> radii,
                              const BoxFilterConfig& config) {
  float largest = 0;
  for (const float r : radii) check_radius(double{r}), largest = std::max(largest, r);
  std::vector<float> out(image.values.size());
  box_filter(table_for(image, double{largest}, config), radii, config.border, out);
  return out;
}

double box_variance(double radius) {
  check_radius(radius);
  const double k = std::floor(radius), f = radius - k;
  return (k * (k + 1) * (2 * k + 1) / 3 + 2 * f * (k + 1) * (k + 1)) / (2 * k + 1 + 2 * f);
}

double iterated_box_radius(double sigma, int passes) {
  if (!(sigma >= 0 && sigma <= kLargestRadius / 2) || passes < 1)
    throw ValueError(fmt::format("{} box filters for a sigma of {}", passes, sigma));
  const double variance = sigma * sigma / passes;
  // The widest whole box whose variance, k(k + 1) / 3, is not above; then its edge's weight.
  const double k = std::floor((std::sqrt(1 + 12 * variance) - 1) / 2);
  const double missing = variance - k * (k + 1) / 3;
  const double f = (2 * k + 1) * missing / (2 * ((k + 1) * (k + 1) - variance));
  return k + std::clamp(f, 0.0, 1.0);
}

std::vector<float> iterated_box_filter(const PixelView& image, double sigma, int passes,
                                       const BoxFilterConfig& config) {
  const double radius = iterated_box_radius(sigma, passes);
  check_radius(radius);
  std::vector<float> out = box_filter(image, radius, config);
  BoxFilterConfig again = config;
  again.range.reset();  // a constant border may have brought values beyond it
  for (int pass = 1; pass < passes; ++pass)
    out = box_filter({out, image.width, image.height, image.channels}, radius, again);
  return out;
}

}  // namespace relumbre
