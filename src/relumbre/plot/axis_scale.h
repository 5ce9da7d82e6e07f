/// An axis' range and ticks, and where on it a value is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "relumbre/plot/figure.h"
#include "relumbre/plot/ticks.h"

namespace relumbre {

/// The least and the greatest value on an axis.
struct Range {
  double low = 0, high = 0;
};

/// From values to 0…1 along the axis.
class AxisScale {
 public:
  /// Takes the data's range. Throws ValueError, naming the axis, where a logarithmic axis has a
  /// value that is not positive, a category does not exist, or data lies outside a fixed range.
  AxisScale(const Axis& axis, Range data, bool from_zero, int most_ticks);

  [[nodiscard]] double operator()(double value) const;
  [[nodiscard]] const std::vector<Tick>& ticks() const { return ticks_; }
  [[nodiscard]] Range range() const { return {low_, high_}; }

 private:
  void take_categories(const Axis& axis, Range data);
  void widen(Range data, bool from_zero);
  void fix_ends(const Axis& axis, Range data);

  double low_ = 0, high_ = 1;
  bool log_ = false;
  std::vector<Tick> ticks_;
};

/// The range of everything that a panel draws, along x or y. Throws ValueError, naming the panel,
/// where there is nothing, or a value is not finite, beyond ±1e300, or within
/// ±1e-290 but not 0.
Range range_of_x(const Panel& panel);
Range range_of_y(const Panel& panel);

}  // namespace relumbre
