#include "relumbre/dof/aperture_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/dof/outline.h"

namespace relumbre {

namespace {

/// What a strip of rows covers of an outline.
struct Strip {
  double width = 0, center = 0, height = 0;  // means over the rows that are reached into

  [[nodiscard]] double area() const { return width * height; }
};

/// ∫ of the half chord √(r² − t²) from 0 to t.
double disc_integral(double t, double r) {
  t = std::clamp(t, -r, r);
  return 0.5 * (t * std::sqrt(r * r - t * t) + r * r * std::asin(t / r));
}

/// The part of a polygon below (sign = 1) or above (sign = -1) the line y = level.
OutlineCorners clip(const OutlineCorners& polygon, double level, double sign) {
  OutlineCorners result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a.y - level), db = sign * (b.y - level);
    if (da >= 0) result.push_back(a);
    if ((da < 0) != (db < 0)) {
      const double t = da / (da - db);
      result.push_back({a.x + t * (b.x - a.x), level});
    }
  }
  return result;
}

Strip measure(const OutlineCorners& polygon) {
  double area = 0, moment = 0, top = 0, bottom = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double cross = a.x * b.y - b.x * a.y;
    area += cross / 2;
    moment += cross * (a.x + b.x) / 6;
    top = i == 0 ? a.y : std::min(top, a.y);
    bottom = i == 0 ? a.y : std::max(bottom, a.y);
  }
  if (area == 0 || top == bottom) return {};
  return {std::abs(area) / (bottom - top), moment / area, bottom - top};
}

/// An outline of diameter 1, to be scaled.
class Outline {
 public:
  Outline(BlurShape shape, const Aperture& aperture) : corners_(outline_corners(shape, aperture)) {}

  /// The strip y0 ≤ y < y1 of the outline at this diameter.
  [[nodiscard]] Strip strip(double diameter, double y0, double y1) const {
    if (corners_.empty()) {
      const double r = diameter / 2, height = std::min(y1, r) - std::max(y0, -r);
      if (height <= 0) return {};
      return {2 * (disc_integral(y1, r) - disc_integral(y0, r)) / height, 0, height};
    }
    OutlineCorners scaled;
    for (const Vec2d& corner : corners_)
      scaled.push_back({corner.x * diameter, corner.y * diameter});
    return measure(clip(clip(scaled, y0, 1), y1, -1));
  }

 private:
  OutlineCorners corners_;  // none: a disc
};

/// Pixel i covers [i − ½, i + ½).
ApertureKernel::Span span_of(const Strip& strip) {
  const double left = strip.center - strip.width / 2, right = strip.center + strip.width / 2;
  const double begin = std::floor(left + 0.5), end = std::floor(right + 0.5);
  return {static_cast<int>(begin), static_cast<int>(end), static_cast<float>(left + 0.5 - begin),
          static_cast<float>(right + 0.5 - end), static_cast<float>(strip.height)};
}

int reach_of(const ApertureKernel& kernel) {
  int reach = 0;
  for (const ApertureKernel::Span& row : kernel.rows)
    reach = std::max({reach, -row.begin, row.end + 1});
  return reach;
}

ApertureKernel kernel_of(const Outline& outline, double diameter) {
  constexpr double kNothing = 1e-9;
  ApertureKernel kernel;
  const int reach = static_cast<int>(std::ceil(diameter / 2 + 0.5));
  double area = 0;
  for (int row = -reach; row <= reach; ++row) {
    const Strip strip = outline.strip(diameter, row - 0.5, row + 0.5);
    if (strip.area() < kNothing * diameter) continue;
    if (kernel.rows.empty()) kernel.top = row;
    kernel.rows.push_back(span_of(strip));
    area += strip.area();
  }
  kernel.share = 1 / area;
  kernel.reach = reach_of(kernel);
  return kernel;
}

ApertureKernel turned(const ApertureKernel& kernel) {
  ApertureKernel result = kernel;
  result.top = 1 - kernel.bottom();
  result.rows.clear();
  for (auto row = kernel.rows.rbegin(); row != kernel.rows.rend(); ++row) {
    const double left = row->begin + static_cast<double>(row->begin_fraction) - 0.5;
    const double right = row->end + static_cast<double>(row->end_fraction) - 0.5;
    result.rows.push_back(
        span_of({right - left, -(left + right) / 2, static_cast<double>(row->height)}));
  }
  result.reach = reach_of(result);
  return result;
}

double diameter_of(std::uint32_t step) {
  using namespace kernel_steps;
  if (step <= kEvenSteps) return step / kStepsPerPixel;
  return static_cast<double>(std::bit_cast<float>((step - kEvenSteps + kEven) << kDroppedBits));
}

}  // namespace

ApertureKernels::ApertureKernels(BlurShape shape, const Aperture& aperture,
                                 double largest_diameter) {
  aperture.check();
  if (!(largest_diameter >= 0 && largest_diameter <= kLargest)) {
    throw ValueError(fmt::format("circle of confusion: {:.6g} pixels, the limit is {}",
                                 largest_diameter, kLargest));
  }
  const Outline outline(shape, aperture);
  for (std::uint32_t step = 0; step <= kernel_step(largest_diameter); ++step) {
    behind_.push_back(kernel_of(outline, diameter_of(std::max(step, 1U))));
    before_.push_back(turned(behind_.back()));
  }
}

const ApertureKernel& ApertureKernels::of(double signed_diameter) const {
  const auto& kernels = signed_diameter < 0 ? before_ : behind_;
  return kernels[std::min<std::size_t>(kernel_step(std::min(std::abs(signed_diameter), kLargest)),
                                       kernels.size() - 1)];
}

}  // namespace relumbre
