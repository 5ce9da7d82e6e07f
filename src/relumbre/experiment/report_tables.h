/// The tables of a report, as HTML.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "relumbre/experiment/analysis.h"
#include "relumbre/experiment/cell.h"

namespace relumbre {

/// The facts, and the levels of the factors that the cells have.
std::string facts_table(const std::vector<std::pair<std::string, std::string>>& facts,
                        std::span<const ExperimentCell> cells);

/// A line a scene: reads, M and L of the proposed machine and M of the naive ones, in words and
/// bytes, summed over its cells.
std::string machines_table(std::span<const ExperimentCell> cells);

/// Factors alone, and with the interactions of every two; or the reason why not.
std::string anova_tables(const ResponseAnalysis& analysis);
/// Normality of the residuals, and equality of their variances by factor.
std::string assumption_tables(const ResponseAnalysis& analysis);
/// A line a factor, and the pairs of levels, folded.
std::string kruskal_tables(const ResponseAnalysis& analysis);

}  // namespace relumbre
