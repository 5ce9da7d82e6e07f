/// The statistics of an experiment's cells.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/experiment/cell.h"
#include "relumbre/stats/anova.h"
#include "relumbre/stats/kruskal_wallis.h"
#include "relumbre/stats/normality.h"
#include "relumbre/stats/table.h"
#include "relumbre/stats/variances.h"

namespace relumbre {

/// A result, or why there is none.
template <class T>
struct Outcome {
  std::optional<T> value;
  std::string refusal;
};

/// How much a response changes when one factor alone does: over every set of cells that agree in
/// all other factors, the largest response over the smallest, less 1.
struct AllElseEqual {
  double median = 0, largest = 0;
};

struct FactorAnalysis {
  Outcome<VarianceTest> brown_forsythe, bartlett;  ///< of the residuals
  Outcome<KruskalWallis> kruskal;
  std::vector<DunnPair> pairs;
  Outcome<AllElseEqual> alone;
};

/// One response analysed: M, or L.
struct ResponseAnalysis {
  Table table;                                ///< factors that have two levels or more
  Outcome<Anova> main;                        ///< factors alone
  Outcome<Anova> pairs;                       ///< and interactions of every two
  Outcome<NormalityTest> shapiro, dagostino;  ///< of the residuals of `main`
  std::vector<FactorAnalysis> factors;        ///< one for each of the table's
};

/// The response of the cells as a table. Factors: scene, depth, resolution, traversal, gts, tile,
/// lines; those of one level are left out. Levels are in the order in which they first appear.
/// Throws ValueError without cells.
Table response_table(std::span<const ExperimentCell> cells, const std::string& name,
                     double (*response)(const ExperimentCell&));

/// Every statistic that the table allows; the reason for those that it does not. Throws Cancelled.
ResponseAnalysis analyse_response(Table table, const Progress& progress = no_progress());

}  // namespace relumbre
