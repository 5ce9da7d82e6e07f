/// Panels of data: boxes, histograms, Q-Q plots.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "relumbre/plot/figure.h"

namespace relumbre {

/// Tukey's box of values, at x: quartiles by linear interpolation, whiskers to the outermost value
/// within 1.5 times the distance of the quartiles, the rest outliers.
/// Throws ValueError if there are none or one is not finite.
BoxPlot box_of(std::span<const double> values, double x);

/// Boxes side by side, one a category. Categories without values stay empty.
Panel box_panel(std::string title, std::vector<std::string> categories,
                std::span<const std::vector<double>> groups, Axis y);

/// How many values fall into each of `bins` (1…1000) equally wide intervals; bins = 0: by the rule
/// of Freedman and Diaconis, at most 60. The largest value belongs to the last interval.
/// Throws ValueError as box_of, and for too many bins.
Panel histogram_panel(std::string title, std::span<const double> values, Axis x,
                      std::size_t bins = 0);

/// Sorted values over what they would be under a distribution, and the line through the quartiles
/// of both. Throws ShapeError if the lengths differ, ValueError as box_of.
Panel qq_panel(std::string title, std::span<const double> expected, std::span<const double> values,
               Axis x, Axis y);

}  // namespace relumbre
