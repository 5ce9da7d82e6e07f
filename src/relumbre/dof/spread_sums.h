/// Internal: running sums over a stripe of rows, and the steps that blurs write into them.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
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

/// How a blur's brightness changes across it: 1 + x · right + y · down at offset (x, y) from its
/// centre.
struct Tilt {
  double right = 0, down = 0;
};

/// Points of a slanted surface are blurred the more the farther along the slope they are. What
/// lands on a pixel from them is, per area of the surface in the picture,
///
///   (1 + ⟨x − p, ∇c⟩ / c) / area(c)      p: the point's pixel, x: the pixel it lands on
///
/// which is the Jacobian of the lens point 2 (x − p) / c(p) that looks from x at p; without it,
/// the blurs on a floor would not add up to 1.
inline Tilt tilt_of(const Fragment& fragment, const ApertureKernel& kernel) {
  constexpr double kLargest = 0.9;  // beyond, the surface is seen edge-on
  const double c = static_cast<double>(fragment.coc);
  if (std::abs(c) < 1) return {};
  const Tilt tilt{static_cast<double>(fragment.slope.x) / c,
                  static_cast<double>(fragment.slope.y) / c};
  const double steepest = std::hypot(tilt.right, tilt.down) * kernel.reach;
  const double scale = steepest > kLargest ? kLargest / steepest : 1;
  return {tilt.right * scale, tilt.down * scale};
}

/// Sums of rows [first, last) of a picture of width × height. A box is spread by two running sums,
/// and is not tilted; all other blurs row by row, with one.
template <class Sum, bool kBox>
class SpreadSums {
 public:
  SpreadSums(std::size_t width, std::size_t height, std::size_t first, std::size_t last)
      : width_(static_cast<int>(width)),
        height_(static_cast<int>(height)),
        first_(static_cast<int>(first)),
        last_(static_cast<int>(last)),
        steps_((width + 1) * (last - first)),
        sums_(width * (last - first)) {}

  /// Rows of the picture from which a blur of this diameter may reach the stripe.
  [[nodiscard]] std::pair<std::size_t, std::size_t> source_rows(float diameter) const {
    const int reach = static_cast<int>(std::ceil(diameter / 2)) + 1;
    return {static_cast<std::size_t>(std::max(first_ - reach, 0)),
            static_cast<std::size_t>(std::min(last_ + reach, height_))};
  }
  void clear() { std::ranges::fill(steps_, Step{}); }

  /// Writes the steps of a fragment's blur. Beyond its border the picture goes on as it ends:
  /// fragments there are repeated as far as their blurs reach.
  void spread(const Fragment& fragment, const ApertureKernel& kernel) {
    const Sum light(fragment.color, static_cast<double>(fragment.coverage), kernel.share);
    const int x = static_cast<int>(fragment.x), y = static_cast<int>(fragment.y);
    const Repeats across = repeats(x, width_, kernel.reach, kernel.reach),
                  down = repeats(y, height_, kernel.bottom(), 1 - kernel.top);
    if constexpr (kBox) {
      spread_box(light, kernel, across, down);
    } else {
      const Tilt tilt = tilt_of(fragment, kernel);
      const int begin = std::max(down.first, first_ - kernel.bottom() + 1),
                end = std::min(down.last, last_ - 1 - kernel.top);
      for (int v = begin; v <= end; ++v)
        for (int u = across.first; u <= across.last; ++u) spread_rows(light, kernel, tilt, u, v);
    }
  }

  /// Steps to values.
  void integrate() {
    for (int y = first_; y < last_; ++y) {
      const Step* steps = step_row(y);
      Sum* sums = row(static_cast<std::size_t>(y - first_));
      Sum value, slope;
      for (int x = 0; x < width_; ++x) {
        if constexpr (!kBox) value.add(slope), slope.add(steps[x].slope);
        value.add(steps[x].value);
        sums[x] = value;
      }
      if (!kBox || y == first_) continue;
      const Sum* above = sums - width_;
      for (int x = 0; x < width_; ++x) sums[x].add(above[x]);
    }
  }
  [[nodiscard]] Sum* row(std::size_t y) {
    return sums_.data() + y * static_cast<std::size_t>(width_);
  }

 private:
  /// A coordinate and those of its repetitions beyond the border.
  struct Repeats {
    int first, last;
  };
  static Repeats repeats(int at, int size, int before, int after) {
    return {at == 0 ? -before : at, at == size - 1 ? at + after : at};
  }

  struct Flat {
    Sum value;
  };
  struct Sloped : Flat {
    Sum slope;
  };
  /// At this column and all to the right of it the sum grows by `value`, and from column to column
  /// by `slope`.
  using Step = std::conditional_t<kBox, Flat, Sloped>;

  [[nodiscard]] Step* step_row(int y) {
    return steps_.data() +
           static_cast<std::size_t>(y - first_) * (static_cast<std::size_t>(width_) + 1);
  }
  /// From `column` on, `scale` times a brightness of `level` at the center, tilted. To the left of
  /// the picture it begins at its border, to the right not at all (the column `width` is never
  /// read).
  void step(Step* row, int center, int column, const Sum& light, double scale, double level,
            double tilt) const {
    column = std::clamp(column, 0, width_);
    row[column].value.add(light, scale * (level + tilt * (column - center)));
    if constexpr (!kBox) row[column].slope.add(light, scale * tilt);
  }
  void steps(Step* row, int x, const ApertureKernel::Span& span, const Sum& light, double scale,
             double level, double tilt) const {
    const auto begin = static_cast<double>(span.begin_fraction),
               end = static_cast<double>(span.end_fraction);
    step(row, x, x + span.begin, light, scale * (1 - begin), level, tilt);
    step(row, x, x + span.begin + 1, light, scale * begin, level, tilt);
    step(row, x, x + span.end, light, scale * (end - 1), level, tilt);
    step(row, x, x + span.end + 1, light, scale * -end, level, tilt);
  }
  void spread_rows(const Sum& light, const ApertureKernel& kernel, const Tilt& tilt, int x, int y) {
    const int top = y + kernel.top;
    const int begin = std::max(first_, top), end = std::min(last_, y + kernel.bottom());
    for (int v = begin; v < end; ++v) {
      const ApertureKernel::Span& span = kernel.rows[static_cast<std::size_t>(v - top)];
      steps(step_row(v), x, span, light, static_cast<double>(span.height), 1 + tilt.down * (v - y),
            tilt.right);
    }
  }
  /// A box is a product of two spans, of which the repetitions add up along each axis.
  void spread_box(const Sum& light, const ApertureKernel& kernel, const Repeats& across,
                  const Repeats& down) {
    profile(kernel.side, across, 0, width_, columns_);
    profile(kernel.side, down, first_, last_, rows_);
    for (const auto& [y, down_scale] : rows_) {
      Step* row = step_row(y);
      for (const auto& [x, scale] : columns_) row[x].value.add(light, scale * down_scale);
    }
  }
  struct AxisStep {
    int at;
    double scale;
  };
  /// The steps of a span's repetitions, in order; those before `begin` are taken there, those from
  /// `end` on left out.
  void profile(const ApertureKernel::Span& span, const Repeats& repeats, int begin, int end,
               std::vector<AxisStep>& steps) {
    const auto rise = static_cast<double>(span.begin_fraction),
               fall = static_cast<double>(span.end_fraction);
    const auto from = [begin](int at) { return std::max(at, begin); };
    steps.clear();
    if (repeats.first == repeats.last) {
      const int at = repeats.first;
      for (const AxisStep& step :
           {AxisStep{from(at + span.begin), 1 - rise}, AxisStep{from(at + span.begin + 1), rise},
            AxisStep{from(at + span.end), fall - 1}, AxisStep{from(at + span.end + 1), -fall}})
        append(step, end, steps);
      return;
    }
    const int last = std::min(repeats.last + span.end + 2, end);
    const int first = std::min(from(repeats.first + span.begin), last);
    summed_.assign(static_cast<std::size_t>(last - first), 0.0);
    const auto add = [&](int at, double scale) {
      if (from(at) < last) summed_[static_cast<std::size_t>(from(at) - first)] += scale;
    };
    for (int at = repeats.first; at <= repeats.last; ++at) {
      add(at + span.begin, 1 - rise), add(at + span.begin + 1, rise);
      add(at + span.end, fall - 1), add(at + span.end + 1, -fall);
    }
    for (int at = first; at < last; ++at) {
      const double scale = summed_[static_cast<std::size_t>(at - first)];
      if (scale != 0) steps.push_back({at, scale});
    }
  }
  /// Two steps at one place are one.
  static void append(const AxisStep& step, int end, std::vector<AxisStep>& steps) {
    if (step.at >= end) return;
    if (!steps.empty() && steps.back().at == step.at) {
      steps.back().scale += step.scale;
    } else {
      steps.push_back(step);
    }
  }

  int width_, height_, first_, last_;
  std::vector<AxisStep> columns_, rows_;  // of a box
  std::vector<double> summed_;
  std::vector<Step> steps_;
  std::vector<Sum> sums_;
};

}  // namespace relumbre
