#include "relumbre/plot/legend.h"

#include <algorithm>

#include <fmt/format.h>

namespace relumbre {

namespace {

constexpr double kTextSize = 12, kRow = 20, kKey = 26, kGap = 18;

}  // namespace

Legend::Legend(const Figure& figure) : palette_(figure.palette) {
  for (const Panel& panel : figure.panels)
    for (const Series& series : panel.series) {
      if (series.name.empty() || std::ranges::find(names_, series.name) != names_.end()) continue;
      names_.push_back(series.name);
      has_line_.push_back(series.line);
      has_markers_.push_back(series.markers);
    }
}

SeriesStyle Legend::style(const std::string& name) const {
  const auto found = std::ranges::find(names_, name);
  if (found == names_.end()) return series_style(SeriesColors::kDistinct, 0, 1);
  return series_style(palette_, static_cast<std::size_t>(found - names_.begin()), names_.size());
}

std::vector<Legend::Place> Legend::places(double width) const {
  std::vector<Place> places;
  Place next;
  for (const std::string& name : names_) {
    const double wide = kKey + 6 + text_width(name, kTextSize);
    if (next.x > 0 && next.x + wide > width) next = {0, next.y + kRow};
    places.push_back(next);
    next.x += wide + kGap;
  }
  return places;
}

double Legend::height(double width) const {
  return names_.empty() ? 0 : places(width).back().y + kRow;
}

void Legend::draw(SvgWriter& svg, double x, double y, double width) const {
  const std::vector<Place> at = places(width);
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const SeriesStyle look = style(names_[i]);
    const double left = x + at[i].x, middle = y + at[i].y + kRow / 2;
    if (has_line_[i])
      svg.path(fmt::format("M{:.2f} {:.2f}h{:.2f}", left, middle, kKey), "", look.color, 1.8,
               look.dashes);
    if (has_markers_[i]) svg.mark(look.mark, left + kKey / 2, middle, 3.2, look.color);
    svg.text(left + kKey + 6, middle + 4, names_[i], {.size = kTextSize});
  }
}

}  // namespace relumbre
