/// An experiment as one page that a researcher can cite.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/experiment/cell.h"
#include "relumbre/experiment/report_figures.h"

namespace relumbre {

struct ReportInput {
  std::string title;
  /// What was run, as name and value: "plan" → "thesis.toml", "version" → "0.1.0" …
  std::vector<std::pair<std::string, std::string>> facts;
  std::span<const ExperimentCell> cells;
  /// Figures that cells do not have the data for, such as reads per node address.
  std::vector<NamedFigure> more_figures;
};

struct ExperimentReport {
  std::string html;                  ///< self-contained: figures inline, nothing loaded, no scripts
  std::vector<NamedFigure> figures;  ///< those of the page
};

/// Figures, tables (memory accesses of the three machines, ANOVA with the checks of its
/// assumptions, Kruskal-Wallis, effect sizes, post-hoc pairs with Holm's correction) and readings
/// in words that follow from the numbers, for M and L. Statistics that the cells do not allow are
/// replaced by the reason. The same cells give the same bytes. Progress is only asked whether to
/// stop. Throws ValueError without cells, or for a cell whose number of levels is not its depth;
/// Cancelled.
ExperimentReport make_report(const ReportInput& input, const Progress& progress = no_progress());

}  // namespace relumbre
