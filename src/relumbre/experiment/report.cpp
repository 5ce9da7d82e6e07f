#include "relumbre/experiment/report.h"

#include <algorithm>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/experiment/analysis.h"
#include "relumbre/experiment/html.h"
#include "relumbre/experiment/readings.h"
#include "relumbre/experiment/report_tables.h"
#include "relumbre/plot/svg.h"

namespace relumbre {

namespace {

constexpr const char* kWarning =
    "<p class=\"warning\"><b>Read p with care.</b> The simulator is deterministic: run again, "
    "every "
    "cell gives the same numbers, and there is no replication noise for F and H to compare effects "
    "with. What stands in for it is how cells differ within a level, that is the other factors: "
    "scene "
    "and resolution are blocks, not samples. With this many cells almost any difference is "
    "&ldquo;significant&rdquo;; the sizes of the effects are what to read.</p>\n";

constexpr const char* kDefinitions =
    "<p><b>M</b> is the number of words that all caches together fetched from the memory of the "
    "octree, Σ misses over units and levels; <b>L</b> is Σ hits / Σ reads over all caches. A "
    "machine without caches fetches every word that is read (<i>naive, words</i>, 2 bytes each); "
    "one "
    "whose nodes are records of pointers fetches a record of 32 bytes for every task "
    "(<i>naive, pointers</i>).</p>\n";

void check(std::span<const ExperimentCell> cells) {
  if (cells.empty()) throw ValueError("a report needs cells");
  for (const ExperimentCell& cell : cells)
    if (cell.levels.size() != cell.depth)
      throw ValueError(fmt::format("cell of scene \"{}\", depth {}: it has {} levels", cell.scene,
                                   cell.depth, cell.levels.size()));
}

class ReportWriter {
 public:
  ReportWriter(const ReportInput& input, const Progress& progress)
      : input_(input), progress_(progress) {}

  ExperimentReport write() {
    body_ = "<h1>" + html::text(input_.title) + "</h1>\n";
    what_was_run();
    machines();
    response("M", "m", "words fetched",
             [](const ExperimentCell& cell) { return static_cast<double>(cell_fetches(cell)); },
             {"M (words fetched)", Scale::kLog10});
    response("L", "l", "hits / reads", cell_hit_rate, {"L (hits / reads)"});
    more_figures();
    report_.html = html::page(input_.title, body_);
    return std::move(report_);
  }

 private:
  void what_was_run() {
    body_ += "<h2>What was run</h2>\n" + facts_table(input_.facts, input_.cells) + kDefinitions;
  }

  void machines() {
    body_ += "<h2>Three machines</h2>\n" + machines_table(input_.cells);
    add(figure_by_scene(input_.cells),
        "Means over tiles, resolutions and whatever else varies. Logarithmic.");
    add(figure_by_level(input_.cells), "Hits over reads, summed over all cells of a scene.");
    add(figure_cache_size(input_.cells),
        "Left: mean L of a resolution. Middle: the words in lines that were ever filled, a unit's "
        "mean. Right: the words that one unit's caches can hold. Without tags.");
  }

  void response(const std::string& name, const std::string& file, const std::string& unit,
                double (*value)(const ExperimentCell&), const Axis& axis) {
    const ResponseAnalysis analysis =
        analyse_response(response_table(input_.cells, name, value), progress_);
    body_ += fmt::format("<h2>{}, {}</h2>\n", name, unit);
    if (analysis.table.factors.empty()) {
      body_ += html::paragraph("No factor has two levels: there is nothing to compare.");
      return;
    }
    body_ += "<h3>In words</h3>\n" + html::list(readings(analysis)) + kWarning;
    add(figure_by_factor(analysis, file + "-by-factor", axis),
        "Median, quartiles, whiskers to 1.5 times their distance, and what lies beyond.");
    body_ += "<h3>Analysis of variance</h3>\n" + anova_tables(analysis);
    if (analysis.main.value)
      add(figure_residuals(analysis, file + "-residuals"), "Residuals of the factors' model.");
    body_ += assumption_tables(analysis);
    body_ += "<h3>Kruskal-Wallis</h3>\n" + kruskal_tables(analysis);
  }

  void more_figures() {
    if (input_.more_figures.empty()) return;
    body_ += "<h2>Further figures</h2>\n";
    for (const NamedFigure& figure : input_.more_figures) add(figure, "");
  }

  void add(NamedFigure figure, const std::string& caption) {
    progress_.check();
    if (figure.figure.panels.empty()) return;
    body_ += "<figure>\n" + to_svg(figure.figure) + "<figcaption>Figure " +
             std::to_string(report_.figures.size() + 1) + ". " + html::text(figure.figure.title) +
             ". " + caption + "</figcaption>\n</figure>\n";
    report_.figures.push_back(std::move(figure));
  }

  const ReportInput& input_;
  const Progress& progress_;
  ExperimentReport report_;
  std::string body_;
};

}  // namespace

ExperimentReport make_report(const ReportInput& input, const Progress& progress) {
  check(input.cells);
  return ReportWriter(input, progress).write();
}

}  // namespace relumbre
