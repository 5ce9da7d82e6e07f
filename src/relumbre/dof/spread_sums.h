/// Internal: running sums over a stripe of rows, and the steps that blurs write into them.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "relumbre/dof/aperture_kernel.h"
#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/lane_sums.h"

namespace relumbre {

/// Sums of rows [first, last) of a picture of width × height. Blurs of any outline are spread row
/// by row: four steps for each.
template <class Sum>
class SpreadSums {
 public:
  /// `kernels` outlive this.
  SpreadSums(const ApertureKernels& kernels, std::size_t width, std::size_t height,
             std::size_t first, std::size_t last)
      : kernels_(kernels),
        width_(static_cast<int>(width)),
        height_(static_cast<int>(height)),
        first_(static_cast<int>(first)),
        last_(static_cast<int>(last)),
        sums_(width) {}

  /// Begins anew.
  void clear(float /*largest_diameter*/) {
    steps_.resize(static_cast<std::size_t>((width_ + 1) * (last_ - first_)));
    top_ = last_, bottom_ = first_;
  }

  /// Writes the steps of a fragment's blur. Beyond its border the picture goes on as it ends:
  /// fragments there are repeated as far as their blurs reach.
  void spread(const Fragment& fragment) {
    const ApertureKernel& kernel = kernels_.of(static_cast<double>(fragment.coc));
    const Sum light(fragment.color, static_cast<double>(fragment.coverage), kernel.share);
    const Repeats across = repeats(fragment.x, width_, kernel.reach, kernel.reach),
                  down = repeats(fragment.y, height_, kernel.bottom(), 1 - kernel.top);
    const Tilt tilt = tilt_of(fragment, kernel.reach);
    const int begin = std::max(down.first, first_ - kernel.bottom() + 1),
              end = std::min(down.last, last_ - 1 - kernel.top);
    for (int v = begin; v <= end; ++v)
      for (int u = across.first; u <= across.last; ++u) spread_rows(light, kernel, tilt, u, v);
  }

  /// Steps to values, leaving no steps behind: calls use(y − first, begin, end, the row's sums) for
  /// rows y and columns [begin, end).
  template <class Use>
  void integrate(Use&& use) {
    for (int y = top_; y < bottom_; ++y) {
      Step* steps = step_row(y);
      Sum value, slope;
      for (int x = 0; x < width_; ++x) {
        value.add(slope), slope.add(steps[x].slope), value.add(steps[x].value);
        sums_[static_cast<std::size_t>(x)] = value;
        steps[x] = Step{};
      }
      steps[width_] = Step{};
      use(static_cast<std::size_t>(y - first_), 0, sums_.size(), sums_.data());
    }
  }

 private:
  /// At this column and all to the right of it the sum grows by `value`, and from column to column
  /// by `slope`.
  struct Step {
    Sum value, slope;
  };

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
    row[column].slope.add(light, scale * tilt);
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
    top_ = std::min(top_, begin), bottom_ = std::max(bottom_, end);
    for (int v = begin; v < end; ++v) {
      const ApertureKernel::Span& span = kernel.rows[static_cast<std::size_t>(v - top)];
      steps(step_row(v), x, span, light, static_cast<double>(span.height), 1 + tilt.down * (v - y),
            tilt.right);
    }
  }

  const ApertureKernels& kernels_;
  int width_, height_, first_, last_;
  int top_ = 0, bottom_ = 0;  // rows that something was spread to
  std::vector<Step> steps_;
  std::vector<Sum> sums_;
};

}  // namespace relumbre
