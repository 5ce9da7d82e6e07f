#include "relumbre/sat/axis_window.h"

#include <algorithm>
#include <cmath>

namespace relumbre {

AxisWindow::AxisWindow(double low, double high, std::size_t size, Border border)
    : size_(static_cast<double>(size)), length_(high - low) {
  if (border == Border::kClamp) add_clamped(low, high);
  if (border == Border::kConstant) add_inside(low, high);
  if (border == Border::kMirror) add_mirrored(low, high);
}

void AxisWindow::add(std::size_t begin, std::size_t end, double weight) {
  if (begin >= end || !(weight > 0)) return;
  segments_[count_++] = {begin, end, weight};
  covered_ += weight * static_cast<double>(end - begin);
}

/// A pixel in part, whole pixels, a pixel in part.
void AxisWindow::add_inside(double low, double high) {
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

void AxisWindow::add_clamped(double low, double high) {
  const auto size = static_cast<std::size_t>(size_);
  add(0, 1, std::min(high, 0.0) - low);
  add_inside(low, high);
  add(size - 1, size, high - std::max(low, size_));
}

/// The mirrored image has a period of twice its size: image, mirrored image.
void AxisWindow::add_mirrored(double low, double high) {
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
