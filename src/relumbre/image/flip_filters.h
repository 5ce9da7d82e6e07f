/// The filters of FLIP, all products of a horizontal and a vertical one.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace relumbre {

/// A row-major plane of width × height.
struct FilterPlane {
  std::size_t width = 0, height = 0;
  std::vector<float> values;

  FilterPlane() = default;
  FilterPlane(std::size_t w, std::size_t h) : width(w), height(h), values(w * h) {}
};

/// Weights of offsets −r .. r.
using FilterKernel = std::vector<float>;

struct FlipFilters {
  FilterKernel achromatic, red_green;       ///< contrast sensitivity; used in both directions
  std::array<FilterKernel, 2> blue_yellow;  ///< a sum of two, each used in both directions
  FilterKernel edge, point;  ///< first and second derivative of a Gaussian; `smooth` across
  FilterKernel smooth;
};

/// Constants: Andersson et al. 2020, table 1 and §4.2.
FlipFilters flip_filters(double pixels_per_degree);

/// Σ over offsets of horizontal[i] · vertical[j] · plane; the nearest pixel counts beyond borders.
/// 2 flops a pixel and weight, parallel over rows.
FilterPlane convolved(const FilterPlane& plane, const FilterKernel& horizontal,
                      const FilterKernel& vertical);

}  // namespace relumbre
