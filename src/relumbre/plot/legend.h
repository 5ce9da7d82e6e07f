/// The key of a figure's series.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "relumbre/plot/figure.h"
#include "relumbre/plot/palette.h"
#include "relumbre/plot/svg_writer.h"

namespace relumbre {

/// Gives every name of a figure's series a style and draws the key, in rows.
class Legend {
 public:
  explicit Legend(const Figure& figure);

  /// The style of a series of this name; that of a lone series where it has none.
  [[nodiscard]] SeriesStyle style(const std::string& name) const;
  /// Pixels from top to bottom when the figure is this wide; 0 without names.
  [[nodiscard]] double height(double width) const;
  void draw(SvgWriter& svg, double x, double y, double width) const;

 private:
  struct Place {
    double x = 0, y = 0;
  };
  [[nodiscard]] std::vector<Place> places(double width) const;

  SeriesColors palette_;
  std::vector<std::string> names_;
  std::vector<bool> has_line_, has_markers_;
};

}  // namespace relumbre
