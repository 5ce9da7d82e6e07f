/// What a figure shows: panels with axes, and the marks in them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace relumbre {

enum class Scale { kLinear, kLog10, kCategories };

/// An axis. Its range is that of the data with a little room, unless given.
struct Axis {
  std::string label;  ///< with the unit: "words fetched", "time (ms)"
  Scale scale = Scale::kLinear;
  std::vector<std::string> categories = {};   ///< kCategories: the names at 0, 1, 2 …
  std::optional<double> low = {}, high = {};  ///< a fixed end; the data must lie within
};

struct Point {
  double x = 0, y = 0;
};

/// Points that belong together, joined or not. Series of one name in several panels look the same.
struct Series {
  std::string name;  ///< in the legend; empty: not there
  std::vector<Point> points = {};
  bool line = true, markers = true;
};

/// Five numbers and what lies beyond the whiskers, drawn at an x.
struct BoxPlot {
  double x = 0, low = 0, q1 = 0, median = 0, q3 = 0, high = 0;
  std::vector<double> outliers = {};
};

/// A bar of a histogram, from 0 to y.
struct Bar {
  double x0 = 0, x1 = 0, y = 0;
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Series> series = {};
  std::vector<BoxPlot> boxes = {};
  std::vector<Bar> bars = {};
};

/// How series are told apart, by marks too: colours that colour-blind readers tell apart, or from
/// dark to light where the series have an order, such as depths.
enum class SeriesColors { kDistinct, kOrdered };

struct Figure {
  std::string title;
  std::vector<Panel> panels = {};
  std::size_t columns = 1;                ///< panels side by side
  bool share_x = false, share_y = false;  ///< one range for all panels
  SeriesColors palette = SeriesColors::kDistinct;
  double width = 420, height = 260;  ///< of a panel inside its axes, in pixels, 40…4000
};

}  // namespace relumbre
