#include "relumbre/plot/axis_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr double kRoom = 0.04;      // of the data's range, at either end
constexpr double kLargest = 1e300;  // ranges of larger values overflow
constexpr double kFarthestEnd = 1e301;
constexpr double kSmallest = 1e-290;  // steps between smaller ones underflow

/// Collects the values of a panel along one direction.
class RangeFinder {
 public:
  explicit RangeFinder(const std::string& panel) : panel_(panel) {}

  void add(double value) {
    if (!(std::abs(value) <= kLargest) || (value != 0 && std::abs(value) < kSmallest))
      throw ValueError(fmt::format("panel \"{}\": {} cannot be drawn", panel_, value));
    range_ = {std::min(range_.low, value), std::max(range_.high, value)};
  }

  [[nodiscard]] Range get() const {
    if (range_.low > range_.high)
      throw ValueError(fmt::format("panel \"{}\": there is nothing to draw", panel_));
    return range_;
  }

 private:
  const std::string& panel_;
  Range range_{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
};

}  // namespace

AxisScale::AxisScale(const Axis& axis, Range data, bool from_zero, int most_ticks) {
  log_ = axis.scale == Scale::kLog10;
  if (axis.scale == Scale::kCategories) {
    take_categories(axis, data);
    return;
  }
  if (log_ && !(data.low > 0))
    throw ValueError(fmt::format("axis \"{}\": {} on a logarithmic axis", axis.label, data.low));
  widen(data, from_zero);
  fix_ends(axis, data);
  ticks_ = log_ ? log_ticks(low_, high_, most_ticks) : linear_ticks(low_, high_, most_ticks);
}

void AxisScale::take_categories(const Axis& axis, Range data) {
  const auto count = static_cast<double>(axis.categories.size());
  if (data.low < -0.5 || data.high > count - 0.5)
    throw ValueError(fmt::format("axis \"{}\": {} is none of its {} categories", axis.label,
                                 data.low < -0.5 ? data.low : data.high, count));
  low_ = -0.5;
  high_ = count - 0.5;
  for (std::size_t i = 0; i < axis.categories.size(); ++i)
    ticks_.push_back({static_cast<double>(i), axis.categories[i]});
}

void AxisScale::widen(Range data, bool from_zero) {
  if (log_) {
    const double room = std::max(0.02, kRoom * (std::log10(data.high) - std::log10(data.low)));
    low_ = std::max(data.low / std::pow(10.0, room), 0.1 * kSmallest);
    high_ = std::min(data.high * std::pow(10.0, room), kFarthestEnd);
    return;
  }
  double room = kRoom * (data.high - data.low);
  // A range too narrow for its values' last digits is drawn as a point amid a wider one.
  if (!(room > 1e-12 * std::max(std::abs(data.low), std::abs(data.high))))
    room = data.low == 0 ? 1 : 0.1 * std::abs(data.low);
  const bool near_zero = data.low >= 0 && data.low < 0.25 * data.high;
  low_ = (from_zero || near_zero) && data.low >= 0 ? 0 : data.low - room;
  high_ = data.high + room;
}

void AxisScale::fix_ends(const Axis& axis, Range data) {
  low_ = axis.low.value_or(low_);
  high_ = axis.high.value_or(high_);
  const bool contains = low_ <= data.low && data.high <= high_ && low_ < high_;
  if (!contains || !(std::abs(low_) <= kFarthestEnd && std::abs(high_) <= kFarthestEnd) ||
      (log_ && !(low_ > 0)))
    throw ValueError(fmt::format("axis \"{}\": values from {} to {} on a range from {} to {}",
                                 axis.label, data.low, data.high, low_, high_));
}

double AxisScale::operator()(double value) const {
  if (log_) return (std::log10(value) - std::log10(low_)) / (std::log10(high_) - std::log10(low_));
  return (value - low_) / (high_ - low_);
}

Range range_of_x(const Panel& panel) {
  RangeFinder range(panel.title);
  for (const Series& series : panel.series)
    for (const Point& point : series.points) range.add(point.x);
  for (const BoxPlot& box : panel.boxes) range.add(box.x);
  for (const Bar& bar : panel.bars) {
    range.add(bar.x0);
    range.add(bar.x1);
  }
  return range.get();
}

Range range_of_y(const Panel& panel) {
  RangeFinder range(panel.title);
  for (const Series& series : panel.series)
    for (const Point& point : series.points) range.add(point.y);
  for (const BoxPlot& box : panel.boxes) {
    for (const double v : {box.low, box.q1, box.median, box.q3, box.high}) range.add(v);
    for (const double v : box.outliers) range.add(v);
  }
  for (const Bar& bar : panel.bars) range.add(bar.y);
  return range.get();
}

}  // namespace relumbre
