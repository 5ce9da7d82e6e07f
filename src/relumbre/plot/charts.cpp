#include "relumbre/plot/charts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

std::vector<double> checked_sorted(std::span<const double> values, const std::string& what) {
  if (values.empty()) throw ValueError(what + ": there are no values to draw");
  for (const double v : values)
    if (!std::isfinite(v)) throw ValueError(fmt::format("{}: {} cannot be drawn", what, v));
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  return sorted;
}

double quantile(std::span<const double> sorted, double q) {
  const double place = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

std::size_t bins_for(std::span<const double> sorted) {
  constexpr double kMost = 60;
  const auto n = static_cast<double>(sorted.size());
  const double width = 2 * (quantile(sorted, 0.75) - quantile(sorted, 0.25)) / std::cbrt(n);
  const double range = sorted.back() - sorted.front();
  if (!(width > 0) || !(range > 0)) return range > 0 ? 10 : 1;
  return static_cast<std::size_t>(std::clamp(std::ceil(range / width), 1.0, kMost));
}

}  // namespace

BoxPlot box_of(std::span<const double> values, double x) {
  const std::vector<double> sorted = checked_sorted(values, "box plot");
  BoxPlot box{x, 0, quantile(sorted, 0.25), quantile(sorted, 0.5), quantile(sorted, 0.75), 0, {}};
  const double reach = 1.5 * (box.q3 - box.q1);
  box.low = box.q1;
  box.high = box.q3;
  for (const double v : sorted) {
    if (v < box.q1 - reach || v > box.q3 + reach) {
      box.outliers.push_back(v);
    } else {
      box.low = std::min(box.low, v);
      box.high = std::max(box.high, v);
    }
  }
  return box;
}

Panel box_panel(std::string title, std::vector<std::string> categories,
                std::span<const std::vector<double>> groups, Axis y) {
  Panel panel{std::move(title), {}, std::move(y), {}, {}, {}};
  panel.x.scale = Scale::kCategories;
  panel.x.categories = std::move(categories);
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (!groups[g].empty()) panel.boxes.push_back(box_of(groups[g], static_cast<double>(g)));
  return panel;
}

Panel histogram_panel(std::string title, std::span<const double> values, Axis x, std::size_t bins) {
  constexpr std::size_t kMostBins = 1000;
  const std::vector<double> sorted = checked_sorted(values, "histogram");
  if (bins > kMostBins) throw ValueError(fmt::format("histogram: {} bins, at most 1000", bins));
  if (bins == 0) bins = bins_for(sorted);
  const double low = sorted.front();
  const double range = sorted.back() > low ? sorted.back() - low : 1;
  const double width = range / static_cast<double>(bins);
  std::vector<double> counts(bins, 0.0);
  for (const double v : sorted)
    counts[std::min(bins - 1, static_cast<std::size_t>((v - low) / width))] += 1;
  Panel panel{std::move(title), std::move(x), {"count"}, {}, {}, {}};
  for (std::size_t b = 0; b < bins; ++b)
    panel.bars.push_back({low + static_cast<double>(b) * width,
                          low + static_cast<double>(b + 1) * width, counts[b]});
  return panel;
}

Panel qq_panel(std::string title, std::span<const double> expected, std::span<const double> values,
               Axis x, Axis y) {
  if (expected.size() != values.size())
    throw ShapeError(
        fmt::format("Q-Q plot: {} values, {} expected", values.size(), expected.size()));
  const std::vector<double> sorted = checked_sorted(values, "Q-Q plot");
  const std::vector<double> scores = checked_sorted(expected, "Q-Q plot");
  Series points{"", {}, false, true};
  for (std::size_t i = 0; i < sorted.size(); ++i) points.points.push_back({scores[i], sorted[i]});
  const double x1 = quantile(scores, 0.25), x3 = quantile(scores, 0.75);
  const double y1 = quantile(sorted, 0.25), y3 = quantile(sorted, 0.75);
  Panel panel{std::move(title), std::move(x), std::move(y), {std::move(points)}, {}, {}};
  if (x3 > x1) {
    const auto line = [&](double at) { return Point{at, y1 + (y3 - y1) * (at - x1) / (x3 - x1)}; };
    panel.series.push_back({"", {line(scores.front()), line(scores.back())}, true, false});
  }
  return panel;
}

}  // namespace relumbre
