/// One panel: how much room it needs, and its drawing.
#pragma once

#include "relumbre/plot/axis_scale.h"
#include "relumbre/plot/figure.h"
#include "relumbre/plot/legend.h"
#include "relumbre/plot/svg_writer.h"

namespace relumbre {

/// Pixels outside a panel's axes.
struct Margins {
  double left = 0, right = 0, top = 0, bottom = 0;
};

class PanelDrawing {
 public:
  /// `x`, `y`: the ranges to show. The panel must outlive the drawing.
  PanelDrawing(const Panel& panel, Range x, Range y, double width, double height);

  [[nodiscard]] Margins margins() const;
  /// Draws with the upper left corner of the axes at (left, top).
  void draw(SvgWriter& svg, const Legend& legend, double left, double top) const;

 private:
  [[nodiscard]] bool turned_labels() const;
  [[nodiscard]] double widest_label(const AxisScale& scale) const;
  [[nodiscard]] Point place(Point value, Point corner) const;
  void draw_x_axis(SvgWriter& svg, Point corner) const;
  void draw_y_axis(SvgWriter& svg, Point corner) const;
  void draw_series(SvgWriter& svg, const Legend& legend, const Series& series, Point corner) const;
  void draw_box(SvgWriter& svg, const BoxPlot& box, Point corner) const;

  const Panel& panel_;
  double width_, height_;
  AxisScale x_, y_;
};

}  // namespace relumbre
