#include "relumbre/experiment/report_figures.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "relumbre/archsim/memory_hierarchy.h"
#include "relumbre/archsim/metrics.h"
#include "relumbre/plot/charts.h"

namespace relumbre {

namespace {

/// Means by a key, in the order of the keys.
class Means {
 public:
  void add(double x, double value) {
    auto& [sum, count] = sums_[x];
    sum += value;
    count += 1;
  }
  [[nodiscard]] std::vector<Point> points() const {
    std::vector<Point> points;
    for (const auto& [x, mean] : sums_) points.push_back({x, mean.first / mean.second});
    return points;
  }

 private:
  std::map<double, std::pair<double, double>> sums_;
};

/// The distinct values of something of the cells, in the order in which they come first.
std::vector<std::string> names_of(std::span<const ExperimentCell> cells,
                                  const std::function<std::string(const ExperimentCell&)>& name) {
  std::vector<std::string> names;
  for (const ExperimentCell& cell : cells)
    if (std::ranges::find(names, name(cell)) == names.end()) names.push_back(name(cell));
  return names;
}

std::vector<std::uint64_t> sorted_lines(std::span<const ExperimentCell> cells) {
  std::set<std::uint64_t> lines;
  for (const ExperimentCell& cell : cells) lines.insert(cell.lines);
  return {lines.begin(), lines.end()};
}

std::vector<std::uint32_t> sorted_depths(std::span<const ExperimentCell> cells) {
  std::set<std::uint32_t> depths;
  for (const ExperimentCell& cell : cells) depths.insert(cell.depth);
  return {depths.begin(), depths.end()};
}

Axis depth_axis(std::span<const ExperimentCell> cells) {
  Axis axis{"depth", Scale::kCategories};
  for (const std::uint32_t depth : sorted_depths(cells))
    axis.categories.push_back(std::to_string(depth));
  return axis;
}

template <class T>
double place_of(const std::vector<T>& sorted, const T& value) {
  return static_cast<double>(std::ranges::lower_bound(sorted, value) - sorted.begin());
}

/// Logarithmic, unless some cells fetched nothing: their pictures miss the cube.
Scale scale_of_fetches(std::span<const ExperimentCell> cells) {
  const bool all =
      std::ranges::all_of(cells, [](const ExperimentCell& cell) { return cell_fetches(cell) > 0; });
  return all ? Scale::kLog10 : Scale::kLinear;
}

Panel scene_panel(std::span<const ExperimentCell> cells, const std::string& scene) {
  const std::vector<std::uint64_t> lines = sorted_lines(cells);
  Panel panel{scene, {"cache lines of a deep level", Scale::kCategories}, {"M (words fetched)"}};
  panel.y.scale = scale_of_fetches(cells);
  for (const std::uint64_t l : lines) panel.x.categories.push_back(std::to_string(l));
  for (const std::uint32_t depth : sorted_depths(cells)) {
    Means means;
    for (const ExperimentCell& cell : cells)
      if (cell.scene == scene && cell.depth == depth)
        means.add(place_of(lines, cell.lines), static_cast<double>(cell_fetches(cell)));
    if (!means.points().empty())
      panel.series.push_back({"depth " + std::to_string(depth), means.points()});
  }
  return panel;
}

/// Hits over reads of every level of the cells of a scene and a depth.
Series level_series(std::span<const ExperimentCell> cells, const std::string& scene,
                    std::uint32_t depth) {
  std::vector<CellLevel> sums(depth);
  for (const ExperimentCell& cell : cells) {
    if (cell.scene != scene || cell.depth != depth) continue;
    for (std::size_t n = 0; n < sums.size(); ++n) {
      sums[n].reads += cell.levels[n].reads;
      sums[n].hits += cell.levels[n].hits;
    }
  }
  Series series{scene, {}};
  for (std::size_t n = 0; n < sums.size(); ++n)
    if (sums[n].reads > 0)
      series.points.push_back({static_cast<double>(n), level_hit_rate(sums[n])});
  return series;
}

Panel hit_rate_panel(std::span<const ExperimentCell> cells) {
  Panel panel{"hit rate", depth_axis(cells), {"L (hits / reads)"}};
  const std::vector<std::uint32_t> depths = sorted_depths(cells);
  for (const std::string& resolution : names_of(cells, cell_resolution)) {
    Means means;
    for (const ExperimentCell& cell : cells)
      if (cell_resolution(cell) == resolution)
        means.add(place_of(depths, cell.depth), cell_hit_rate(cell));
    panel.series.push_back({resolution, means.points()});
  }
  return panel;
}

Panel cache_size_panel(std::span<const ExperimentCell> cells) {
  Panel panel{"caches of one unit", depth_axis(cells), {"size (MB)", Scale::kLog10}};
  const std::vector<std::uint32_t> depths = sorted_depths(cells);
  for (const std::uint64_t lines : sorted_lines(cells)) {
    Series series{std::to_string(lines) + " lines", {}};
    for (const std::uint32_t depth : depths)
      series.points.push_back({place_of(depths, depth), unit_cache_bytes(depth, lines) / 1e6});
    panel.series.push_back(std::move(series));
  }
  return panel;
}

/// What the words in use take: lines that were ever filled.
Panel cache_use_panel(std::span<const ExperimentCell> cells) {
  Panel panel{"lines that are used", depth_axis(cells), {"size (MB)", scale_of_fetches(cells)}};
  const std::vector<std::uint32_t> depths = sorted_depths(cells);
  for (const std::string& resolution : names_of(cells, cell_resolution)) {
    Means means;
    for (const ExperimentCell& cell : cells)
      if (cell_resolution(cell) == resolution)
        means.add(place_of(depths, cell.depth), used_cache_bytes(cell) / 1e6);
    panel.series.push_back({resolution, means.points()});
  }
  return panel;
}

}  // namespace

double used_cache_bytes(const ExperimentCell& cell) {
  std::uint64_t lines = 0;
  for (const CellLevel& level : cell.levels) lines += level.lines_used;
  return static_cast<double>(lines * kWordBytes) / cell.gts;
}

double unit_cache_bytes(std::uint32_t depth, std::uint64_t lines) {
  std::uint64_t words = 0;
  for (std::uint32_t level = 0; level < depth; ++level)
    words += lines_of_level(static_cast<int>(level), lines);
  return static_cast<double>(words * kWordBytes);
}

NamedFigure figure_by_factor(const ResponseAnalysis& analysis, const std::string& name,
                             const Axis& response) {
  const Table& table = analysis.table;
  NamedFigure result{name, {table.response + " by factor"}};
  result.figure.columns = 3;
  result.figure.share_y = true;
  result.figure.width = 270;
  result.figure.height = 200;
  Axis axis = response;
  if (std::ranges::min(table.values) <= 0) axis.scale = Scale::kLinear;
  for (const Factor& factor : table.factors)
    result.figure.panels.push_back(
        box_panel(factor.name, factor.levels, groups_of(table.values, factor), axis));
  return result;
}

NamedFigure figure_by_scene(std::span<const ExperimentCell> cells) {
  NamedFigure result{"m-by-scene", {"M against cache lines, for every depth and scene"}};
  for (const std::string& scene : names_of(cells, [](const ExperimentCell& c) { return c.scene; }))
    result.figure.panels.push_back(scene_panel(cells, scene));
  result.figure.columns = 2;
  result.figure.share_y = true;
  result.figure.palette = SeriesColors::kOrdered;
  result.figure.height = 220;
  return result;
}

NamedFigure figure_by_level(std::span<const ExperimentCell> cells) {
  constexpr std::size_t kPanels = 3;
  NamedFigure result{"hit-rate-by-level", {"Hit rate of each level's caches"}};
  std::vector<std::uint32_t> depths = sorted_depths(cells);
  if (depths.size() > kPanels) depths.erase(depths.begin(), depths.end() - kPanels);
  for (const std::uint32_t depth : depths) {
    Panel panel{"depth " + std::to_string(depth), {"level", Scale::kCategories}, {"hits / reads"}};
    for (std::uint32_t n = 0; n < depth; ++n) panel.x.categories.push_back(std::to_string(n));
    for (const std::string& scene :
         names_of(cells, [](const ExperimentCell& c) { return c.scene; })) {
      Series series = level_series(cells, scene, depth);
      if (!series.points.empty()) panel.series.push_back(std::move(series));
    }
    if (!panel.series.empty()) result.figure.panels.push_back(std::move(panel));
  }
  result.figure.columns = kPanels;
  result.figure.share_y = true;
  result.figure.width = 270;
  result.figure.height = 200;
  return result;
}

NamedFigure figure_cache_size(std::span<const ExperimentCell> cells) {
  NamedFigure result{"cache-size", {"Hit rate and size of the caches, by depth"}};
  result.figure.panels = {hit_rate_panel(cells), cache_use_panel(cells), cache_size_panel(cells)};
  result.figure.columns = 3;
  result.figure.width = 270;
  result.figure.height = 200;
  return result;
}

NamedFigure figure_residuals(const ResponseAnalysis& analysis, const std::string& name) {
  const std::vector<double>& residuals = analysis.main.value->residuals;
  NamedFigure result{name, {"Residuals of " + analysis.table.response}};
  result.figure.panels = {histogram_panel("histogram", residuals, {"residual"}),
                          qq_panel("normal Q-Q", normal_scores(residuals.size()), residuals,
                                   {"normal score"}, {"residual"})};
  result.figure.columns = 2;
  result.figure.height = 200;
  return result;
}

}  // namespace relumbre
