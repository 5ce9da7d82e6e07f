#include "relumbre/plot/svg.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/plot/panel_drawing.h"

namespace relumbre {

namespace {

constexpr double kTitleSize = 15, kTitleRow = 21, kEdge = 8;
constexpr double kBoldWidth = 1.15;  // of a bold title, over a plain one
constexpr std::size_t kMostMarks = 1'000'000;

std::size_t marks_of(const Panel& panel) {
  std::size_t marks = panel.bars.size() + panel.boxes.size();
  for (const Series& series : panel.series) marks += series.points.size();
  for (const BoxPlot& box : panel.boxes) marks += box.outliers.size();
  return marks;
}

void check(const Figure& figure) {
  const std::string name = fmt::format("figure \"{}\"", figure.title);
  if (figure.panels.empty()) throw ValueError(name + ": it has no panels");
  if (figure.columns == 0) throw ValueError(name + ": it has no columns");
  for (const double side : {figure.width, figure.height})
    if (!(side >= 40 && side <= 4000))
      throw ValueError(fmt::format("{}: panels of {} x {} pixels, 40 to 4000 are allowed", name,
                                   figure.width, figure.height));
  std::size_t marks = 0;
  for (const Panel& panel : figure.panels) marks += marks_of(panel);
  if (marks > kMostMarks)
    throw ValueError(fmt::format("{}: {} marks, at most {} are drawn", name, marks, kMostMarks));
}

/// Each panel's range, or that of all where it is shared.
std::vector<Range> ranges(const Figure& figure, Range (*range_of)(const Panel&), bool shared) {
  std::vector<Range> result;
  for (const Panel& panel : figure.panels) result.push_back(range_of(panel));
  if (!shared) return result;
  Range all = result[0];
  for (const Range& r : result) all = {std::min(all.low, r.low), std::max(all.high, r.high)};
  return std::vector<Range>(result.size(), all);
}

/// Lines of a text that fit into this width.
std::vector<std::string> wrap(const std::string& text, double size, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || text_width(lines.back() + " " + word, size) > width)
      lines.push_back(word);
    else
      lines.back() += " " + word;
  }
  return lines;
}

/// A shared axis' label stands only at the edge of the grid of panels.
Figure with_outer_labels(Figure figure) {
  const std::size_t count = figure.panels.size();
  figure.columns = std::min(figure.columns, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (figure.share_y && i % figure.columns != 0) figure.panels[i].y.label.clear();
    if (figure.share_x && i + figure.columns < count) figure.panels[i].x.label.clear();
  }
  return figure;
}

/// The panels in a grid whose cells are of one size.
class Grid {
 public:
  explicit Grid(const Figure& figure) : figure_(figure) {
    const auto x = ranges(figure, range_of_x, figure.share_x);
    const auto y = ranges(figure, range_of_y, figure.share_y);
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
      panels_.emplace_back(figure.panels[i], x[i], y[i], figure.width, figure.height);
      const Margins m = panels_.back().margins();
      outer_ = {std::max(outer_.left, m.left), std::max(outer_.right, m.right),
                std::max(outer_.top, m.top), std::max(outer_.bottom, m.bottom)};
    }
  }

  [[nodiscard]] double cell_width() const { return outer_.left + figure_.width + outer_.right; }
  [[nodiscard]] double cell_height() const { return outer_.top + figure_.height + outer_.bottom; }
  [[nodiscard]] double width() const {
    return 2 * kEdge + static_cast<double>(figure_.columns) * cell_width();
  }
  [[nodiscard]] double height() const {
    const std::size_t rows = (panels_.size() + figure_.columns - 1) / figure_.columns;
    return static_cast<double>(rows) * cell_height() + kEdge;
  }

  void draw(SvgWriter& svg, const Legend& legend, double top) const {
    for (std::size_t i = 0; i < panels_.size(); ++i) {
      const auto column = static_cast<double>(i % figure_.columns);
      const auto row = static_cast<double>(i / figure_.columns);
      panels_[i].draw(svg, legend, kEdge + column * cell_width() + outer_.left,
                      top + row * cell_height() + outer_.top);
    }
  }

 private:
  const Figure& figure_;
  std::vector<PanelDrawing> panels_;
  Margins outer_;
};

}  // namespace

std::string to_svg(const Figure& given) {
  check(given);
  const Figure figure = with_outer_labels(given);
  const Legend legend(figure);
  const Grid grid(figure);
  const double width = grid.width(), inner = width - 4 * kEdge;
  SvgWriter svg;
  double y = kEdge;
  for (const std::string& line : wrap(figure.title, kBoldWidth * kTitleSize, inner)) {
    svg.text(2 * kEdge, y + kTitleSize, line, {.size = kTitleSize, .bold = true});
    y += kTitleRow;
  }
  legend.draw(svg, 2 * kEdge, y + 2, inner);
  if (legend.height(inner) > 0) y += 6 + legend.height(inner);
  grid.draw(svg, legend, y);
  return svg.document(width, y + grid.height(), figure.title);
}

}  // namespace relumbre
