/// How a window along one axis, with real bounds, covers the pixels there are. Host and device.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "relumbre/base/host_device.h"

namespace relumbre {

/// What is seen beyond the image's edge.
enum class Border {
  kClamp,     ///< the edge's pixel: a a a | a b c
  kConstant,  ///< a given value:      v v v | a b c
  kMirror,    ///< the image mirrored: c b a | a b c
};

/// Pixels begin … end − 1, each counted `weight` times.
struct AxisSegment {
  std::size_t begin = 0, end = 0;
  double weight = 0;
};

/// The part of [low, high] that each pixel covers, where pixel i is [i, i + 1]. Its length times a
/// pixel's weight is exact for what a piecewise-constant image integrates to.
class AxisWindow {
 public:
  /// low ≤ high, both within ±2^30; size ≥ 1.
  RELUMBRE_HOST_DEVICE AxisWindow(double low, double high, std::size_t size, Border border);

  [[nodiscard]] RELUMBRE_HOST_DEVICE std::span<const AxisSegment> segments() const {
    return {segments_.data(), count_};
  }
  /// Length of the window inside the image, or all of it where the border repeats pixels.
  [[nodiscard]] RELUMBRE_HOST_DEVICE double covered() const { return covered_; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE double length() const { return length_; }

 private:
  RELUMBRE_HOST_DEVICE void add(std::size_t begin, std::size_t end, double weight);
  RELUMBRE_HOST_DEVICE void add_inside(double low, double high);
  RELUMBRE_HOST_DEVICE void add_clamped(double low, double high);
  RELUMBRE_HOST_DEVICE void add_mirrored(double low, double high);

  double size_, length_, covered_ = 0;
  std::size_t count_ = 0;
  std::array<AxisSegment, 10> segments_;  ///< mirrored: whole periods, and three parts of three
};

RELUMBRE_HOST_DEVICE inline AxisWindow::AxisWindow(double low, double high, std::size_t size,
                                                   Border border)
    : size_(static_cast<double>(size)), length_(high - low) {
  if (border == Border::kClamp) add_clamped(low, high);
  if (border == Border::kConstant) add_inside(low, high);
  if (border == Border::kMirror) add_mirrored(low, high);
}

RELUMBRE_HOST_DEVICE inline void AxisWindow::add(std::size_t begin, std::size_t end,
                                                 double weight) {
  if (begin >= end || !(weight > 0)) return;
  segments_[count_++] = {begin, end, weight};
  covered_ += weight * static_cast<double>(end - begin);
}

/// A pixel in part, whole pixels, a pixel in part.
RELUMBRE_HOST_DEVICE inline void AxisWindow::add_inside(double low, double high) {
  low = std::clamp(low, 0.0, size_), high = std::clamp(high, 0.0, size_);
  if (low >= high) return;
  const auto first = static_cast<std::size_t>(std::ceil(low));
  const auto last = static_cast<std::size_t>(std::floor(high));
  const double before = std::ceil(low) - low, after = high - std::floor(high);
  if (first > last) return add(last, first, high - low);  // within one pixel
  add(first - (before > 0 ? 1 : 0), first, before);
  add(first, last, 1);
  add(last, last + (after > 0 ? 1 : 0), after);
}

RELUMBRE_HOST_DEVICE inline void AxisWindow::add_clamped(double low, double high) {
  const auto size = static_cast<std::size_t>(size_);
  add(0, 1, std::min(high, 0.0) - low);
  add_inside(low, high);
  add(size - 1, size, high - std::max(low, size_));
}

/// The mirrored image has a period of twice its size: image, mirrored image.
RELUMBRE_HOST_DEVICE inline void AxisWindow::add_mirrored(double low, double high) {
  const double period = 2 * size_;
  const double shift = std::floor(low / period) * period;
  low -= shift, high -= shift;
  const double periods = std::floor((high - low) / period);
  add(0, static_cast<std::size_t>(size_), 2 * periods);
  high -= periods * period;
  add_inside(low, high);
  if (high > size_) add_inside(period - high, period - std::max(low, size_));
  add_inside(low - period, high - period);
  if (high > period + size_) add_inside(2 * period - high, 2 * period - std::max(low, 3 * size_));
}

}  // namespace relumbre
