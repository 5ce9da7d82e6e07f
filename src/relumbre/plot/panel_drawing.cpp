#include "relumbre/plot/panel_drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace relumbre {

namespace {

constexpr double kTickSize = 11, kLabelSize = 12, kTitleSize = 13;
constexpr double kTurn = 35;  // degrees, for categories' names that are too wide
constexpr const char* kGrid = "#e3e3e3";
constexpr const char* kMinorGrid = "#f2f2f2";
constexpr const char* kFrame = "#888888";
constexpr const char* kBoxFill = "#cfe3f1";
constexpr const char* kInk = "#0072b2";

int most_ticks(double pixels, double apart) {
  return std::max(2, static_cast<int>(pixels / apart));
}

std::string polyline(std::span<const Point> points) {
  std::string data;
  for (const Point& p : points)
    data += fmt::format("{}{:.2f} {:.2f}", data.empty() ? "M" : "L", p.x, p.y);
  return data;
}

/// Many points are drawn small.
double mark_radius(std::size_t points) { return points > 400 ? 1.6 : points > 100 ? 2.2 : 3.2; }

}  // namespace

PanelDrawing::PanelDrawing(const Panel& panel, Range x, Range y, double width, double height)
    : panel_(panel),
      width_(width),
      height_(height),
      x_(panel.x, x, false, most_ticks(width, 60)),
      y_(panel.y, y, !panel.bars.empty(), most_ticks(height, 36)) {}

double PanelDrawing::widest_label(const AxisScale& scale) const {
  double widest = 0;
  for (const Tick& tick : scale.ticks())
    widest = std::max(widest, text_width(tick.label, kTickSize));
  return widest;
}

bool PanelDrawing::turned_labels() const {
  if (panel_.x.scale != Scale::kCategories) return false;
  return widest_label(x_) + 4 > width_ / static_cast<double>(panel_.x.categories.size());
}

Margins PanelDrawing::margins() const {
  const double widest = widest_label(x_);
  Margins m;
  m.left = 8 + widest_label(y_) + 8 + (panel_.y.label.empty() ? 0 : kLabelSize + 10);
  m.right = std::max(12.0, turned_labels() ? 12 : widest / 2);
  m.top = panel_.title.empty() ? 10 : kTitleSize + 14;
  const double labels =
      turned_labels() ? widest * std::sin(kTurn * std::numbers::pi / 180) + kTickSize : kTickSize;
  m.bottom = 8 + labels + 6 + (panel_.x.label.empty() ? 0 : kLabelSize + 8);
  if (turned_labels()) m.left = std::max(m.left, widest * std::cos(kTurn * std::numbers::pi / 180));
  return m;
}

Point PanelDrawing::place(Point value, Point corner) const {
  return {corner.x + width_ * x_(value.x), corner.y + height_ * (1 - y_(value.y))};
}

void PanelDrawing::draw_x_axis(SvgWriter& svg, Point corner) const {
  const double bottom = corner.y + height_;
  const bool turned = turned_labels();
  for (const Tick& tick : x_.ticks()) {
    const double x = corner.x + width_ * x_(tick.value);
    if (panel_.x.scale != Scale::kCategories)
      svg.line(x, corner.y, x, bottom, tick.label.empty() ? kMinorGrid : kGrid, 1);
    svg.line(x, bottom, x, bottom + (tick.label.empty() ? 2 : 4), kFrame, 1);
    if (tick.label.empty()) continue;
    TextStyle style{.size = kTickSize, .anchor = turned ? Anchor::kEnd : Anchor::kMiddle};
    if (turned) style.turned = -kTurn;
    svg.text(x + (turned ? 4 : 0), bottom + 6 + kTickSize, tick.label, style);
  }
  svg.text(corner.x + width_ / 2, bottom + margins().bottom - 8, panel_.x.label,
           {.size = kLabelSize, .anchor = Anchor::kMiddle});
}

void PanelDrawing::draw_y_axis(SvgWriter& svg, Point corner) const {
  for (const Tick& tick : y_.ticks()) {
    const double y = corner.y + height_ * (1 - y_(tick.value));
    svg.line(corner.x, y, corner.x + width_, y, tick.label.empty() ? kMinorGrid : kGrid, 1);
    svg.line(corner.x - (tick.label.empty() ? 2 : 4), y, corner.x, y, kFrame, 1);
    if (!tick.label.empty())
      svg.text(corner.x - 8, y + 4, tick.label, {.size = kTickSize, .anchor = Anchor::kEnd});
  }
  const double x = corner.x - widest_label(y_) - 18;
  svg.text(x, corner.y + height_ / 2, panel_.y.label,
           {.size = kLabelSize, .anchor = Anchor::kMiddle, .turned = -90});
}

void PanelDrawing::draw_series(SvgWriter& svg, const Legend& legend, const Series& series,
                               Point corner) const {
  const SeriesStyle look = legend.style(series.name);
  // A line among points of no name is what they are compared with.
  const bool is_reference = series.name.empty() && !series.markers && panel_.series.size() > 1;
  std::vector<Point> places;
  for (const Point& point : series.points) places.push_back(place(point, corner));
  if (series.line)
    svg.path(polyline(places), "", is_reference ? "#d55e00" : look.color, 1.8, look.dashes);
  if (!series.markers) return;
  for (const Point& p : places)
    svg.mark(look.mark, p.x, p.y, mark_radius(places.size()), look.color);
}

void PanelDrawing::draw_box(SvgWriter& svg, const BoxPlot& box, Point corner) const {
  const double half = std::min(24.0, 0.3 * width_ * (x_(1) - x_(0)));
  const auto at = [&](double v) { return place({box.x, v}, corner); };
  const Point q1 = at(box.q1), q3 = at(box.q3), median = at(box.median), low = at(box.low),
              high = at(box.high);
  svg.line(q1.x, q1.y, low.x, low.y, kInk, 1);
  svg.line(q3.x, q3.y, high.x, high.y, kInk, 1);
  for (const Point& whisker : {low, high})
    svg.line(whisker.x - half / 2, whisker.y, whisker.x + half / 2, whisker.y, kInk, 1);
  svg.rectangle(q3.x - half, q3.y, 2 * half, q1.y - q3.y, kBoxFill, kInk);
  svg.line(median.x - half, median.y, median.x + half, median.y, "#d55e00", 2);
  for (const double v : box.outliers) svg.mark(0, at(v).x, at(v).y, 1.8, kInk);
}

void PanelDrawing::draw(SvgWriter& svg, const Legend& legend, double left, double top) const {
  const Point corner{left, top};
  draw_x_axis(svg, corner);
  draw_y_axis(svg, corner);
  for (const Bar& bar : panel_.bars) {
    const Point from = place({bar.x0, bar.y}, corner), to = place({bar.x1, y_.range().low}, corner);
    svg.rectangle(from.x, from.y, to.x - from.x, to.y - from.y, kBoxFill, kInk);
  }
  for (const BoxPlot& box : panel_.boxes) draw_box(svg, box, corner);
  for (const Series& series : panel_.series) draw_series(svg, legend, series, corner);
  svg.rectangle(left, top, width_, height_, "", kFrame);
  svg.text(left + width_ / 2, top - 8, panel_.title,
           {.size = kTitleSize, .anchor = Anchor::kMiddle, .bold = true});
}

}  // namespace relumbre
