/// Box filters, and what they make of when repeated, in time that does not depend on the radius.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "relumbre/sat/pixel_filter.h"
#include "relumbre/sat/summed_area_table.h"

namespace relumbre {

/// An image of 1 to 4 interleaved channels, row-major, row 0 at the top.
struct PixelView {
  std::span<const float> values;  ///< width · height · channels
  std::size_t width = 0, height = 0, channels = 1;
};

struct BoxFilterConfig {
  SatKind kind = SatKind::kFixed64;
  BorderRule border;
  std::optional<SatRange> range;  ///< as in SatConfig
};

/// The mean over the square of side 2r + 1 about every pixel's centre, of the piecewise-constant
/// image: pixels at the square's edge count by the part of them that lies inside, so the result
/// changes continuously with r, and r = 0 is the image itself. Reads 4 sums a pixel and channel if
/// r is whole, else 16, more near the border. Threaded. Throws what SummedAreaTable::build throws,
/// and ValueError: a radius that is negative, NaN or above 2^20; ShapeError: radii not one a pixel.
/// Source: Crow 1984; Hensley et al. 2005 for a radius that differs from pixel to pixel.
std::vector<float> box_filter(const PixelView& image, double radius,
                              const BoxFilterConfig& config = {});
/// The same with each pixel's own radius.
std::vector<float> box_filter(const PixelView& image, std::span<const float> radii,
                              const BoxFilterConfig& config = {});
/// The same of a table that is there, into `out` (width · height · channels). Throws ValueError
/// also where a fixed kind's largest box is smaller than the square.
void box_filter(const SummedAreaTable& table, double radius, const BorderRule& border,
                std::span<float> out);
void box_filter(const SummedAreaTable& table, std::span<const float> radii,
                const BorderRule& border, std::span<float> out);

/// Variance, in pixels² along an axis, of the box filter of this radius:
/// (k(k+1)(2k+1)/3 + 2f(k+1)²) / (2k+1+2f), where k and f are the whole and the rest of r.
double box_variance(double radius);
/// The radius whose box, applied `passes` times, has exactly the variance sigma². Throws
/// ValueError: sigma negative, NaN or too large, passes below 1. Source: Gwosdek et al. 2011.
double iterated_box_radius(double sigma, int passes);

/// Near-Gaussian blur of standard deviation `sigma` pixels: `passes` box filters whose variances
/// add up to sigma². Along an axis the kernel is nowhere further from the Gaussian's than 6% of its
/// peak with three passes, 3.5% with four.
/// Throws as box_filter and iterated_box_radius.
std::vector<float> iterated_box_filter(const PixelView& image, double sigma, int passes = 3,
                                       const BoxFilterConfig& config = {});

}  // namespace relumbre
