/// Internal: running sums over a stripe of rows, and the steps that blurs write into them.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "relumbre/dof/aperture_kernel.h"
#include "relumbre/dof/depth_layers.h"

namespace relumbre {

/// Colour and weight of a pixel of a layer. Doubles: steps up and down have to cancel beside
/// highlights that are a million times as bright.
template <int kLanes>
struct LaneSum {
  double lane[kLanes] = {};

  void add(const LaneSum& other, double scale) {
    for (int i = 0; i < kLanes; ++i) lane[i] += other.lane[i] * scale;
  }
  void add(const LaneSum& other) {
    for (int i = 0; i < kLanes; ++i) lane[i] += other.lane[i];
  }
};

/// Of pictures whose alpha is 1 wherever there is something.
struct OpaqueSum : LaneSum<4> {
  OpaqueSum() = default;
  OpaqueSum(const Rgba& c, double coverage, double share)
      : LaneSum{{c.r * share, c.g * share, c.b * share, coverage * share}} {}
  [[nodiscard]] double weight() const { return lane[3]; }
  [[nodiscard]] Rgba color() const {
    return {static_cast<float>(lane[0]), static_cast<float>(lane[1]), static_cast<float>(lane[2]),
            static_cast<float>(lane[3])};
  }
};

struct AlphaSum : LaneSum<5> {
  AlphaSum() = default;
  AlphaSum(const Rgba& c, double coverage, double share)
      : LaneSum{{c.r * share, c.g * share, c.b * share, c.a * share, coverage * share}} {}
  [[nodiscard]] double weight() const { return lane[4]; }
  [[nodiscard]] Rgba color() const {
    return {static_cast<float>(lane[0]), static_cast<float>(lane[1]), static_cast<float>(lane[2]),
            static_cast<float>(lane[3])};
  }
};

/// Sums of rows [first, last) of a picture of width × height.
template <class Sum>
class SpreadSums {
 public:
  SpreadSums(std::size_t width, std::size_t height, std::size_t first, std::size_t last)
      : width_(static_cast<int>(width)),
        height_(static_cast<int>(height)),
        first_(static_cast<int>(first)),
        last_(static_cast<int>(last)),
        sums_((width + 1) * (last - first)) {}

  /// Rows of the picture from which a blur of this diameter may reach the stripe.
  [[nodiscard]] std::pair<std::size_t, std::size_t> source_rows(float diameter) const {
    const int reach = static_cast<int>(std::ceil(diameter / 2)) + 1;
    return {static_cast<std::size_t>(std::max(first_ - reach, 0)),
            static_cast<std::size_t>(std::min(last_ + reach, height_))};
  }
  void clear() { std::ranges::fill(sums_, Sum{}); }

  /// Writes the steps of a fragment's blur, and of those of its repetitions beyond the border.
  void spread(const Fragment& fragment, const ApertureKernel& kernel, bool box) {
    const Sum light(fragment.color, fragment.coverage, kernel.share);
    const int x = static_cast<int>(fragment.x), y = static_cast<int>(fragment.y);
    const int up = y == 0 ? kernel.bottom() : 0, down = y == height_ - 1 ? 1 - kernel.top : 0;
    if (y + down + kernel.bottom() <= first_ || y - up + kernel.top >= last_) return;
    const int left = x == 0 ? kernel.reach : 0, right = x == width_ - 1 ? kernel.reach : 0;
    for (int v = y - up; v <= y + down; ++v) {
      for (int u = x - left; u <= x + right; ++u) {
        if (box)
          spread_box(light, kernel, u, v);
        else
          spread_rows(light, kernel, u, v);
      }
    }
  }

  /// Steps to values.
  void integrate(bool box) {
    for (int y = first_; y < last_; ++y) {
      Sum* row = this->row(static_cast<std::size_t>(y - first_));
      for (int x = 1; x < width_; ++x) row[x].add(row[x - 1]);
      if (!box || y == first_) continue;
      const Sum* above = row - (width_ + 1);
      for (int x = 0; x < width_; ++x) row[x].add(above[x]);
    }
  }
  [[nodiscard]] Sum* row(std::size_t y) {
    return sums_.data() + y * (static_cast<std::size_t>(width_) + 1);
  }

 private:
  /// A step at a column: to the left of the picture it is one at its border, to the right it is
  /// none (the column `width` is never read).
  void step(Sum* row, int x, const Sum& light, double scale) const {
    row[std::clamp(x, 0, width_)].add(light, scale);
  }
  void steps(Sum* row, int x, const ApertureKernel::Span& span, const Sum& light,
             double scale) const {
    const auto begin = static_cast<double>(span.begin_fraction),
               end = static_cast<double>(span.end_fraction);
    step(row, x + span.begin, light, scale * (1 - begin));
    step(row, x + span.begin + 1, light, scale * begin);
    step(row, x + span.end, light, scale * (end - 1));
    step(row, x + span.end + 1, light, scale * -end);
  }
  void spread_rows(const Sum& light, const ApertureKernel& kernel, int x, int y) {
    const int top = y + kernel.top;
    const int begin = std::max(first_, top), end = std::min(last_, y + kernel.bottom());
    for (int v = begin; v < end; ++v) {
      const ApertureKernel::Span& span = kernel.rows[static_cast<std::size_t>(v - top)];
      steps(row(static_cast<std::size_t>(v - first_)), x, span, light,
            static_cast<double>(span.height));
    }
  }
  /// A box is a product of two spans.
  void spread_box(const Sum& light, const ApertureKernel& kernel, int x, int y) {
    const ApertureKernel::Span& span = kernel.side;
    const auto begin = static_cast<double>(span.begin_fraction),
               end = static_cast<double>(span.end_fraction);
    const std::pair<int, double> rows[] = {{span.begin, 1 - begin},
                                           {span.begin + 1, begin},
                                           {span.end, end - 1},
                                           {span.end + 1, -end}};
    for (const auto& [at, scale] : rows) {
      const int v = std::max(y + at, first_);
      if (v < last_) steps(row(static_cast<std::size_t>(v - first_)), x, span, light, scale);
    }
  }

  int width_, height_, first_, last_;
  std::vector<Sum> sums_;
};

}  // namespace relumbre
