/// The figures of an experiment.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "relumbre/experiment/analysis.h"
#include "relumbre/experiment/cell.h"
#include "relumbre/plot/figure.h"

namespace relumbre {

/// A figure and what its file is called.
struct NamedFigure {
  std::string name;  ///< "m-by-factor"
  Figure figure;
};

/// Boxes of a response, a panel a factor. `label`: the response with its unit.
NamedFigure figure_by_factor(const ResponseAnalysis& analysis, const std::string& name,
                             const Axis& response);

/// M over lines, a curve a depth, a panel a scene: means over the other factors.
NamedFigure figure_by_scene(std::span<const ExperimentCell> cells);

/// The hit rate of each level over all cells of the deepest (at most three) depths, a panel a
/// depth, a curve a scene: Σ hits / Σ reads.
NamedFigure figure_by_level(std::span<const ExperimentCell> cells);

/// Over depth: L, a curve a resolution; the words that one geometry unit's caches really held, in
/// MB (10^6 bytes) at 2 bytes a line, a curve a resolution; and those that they can hold, a curve
/// for each number of lines.
NamedFigure figure_cache_size(std::span<const ExperimentCell> cells);

/// The distribution of the residuals of the analysis of variance, and its normal Q-Q plot; for an
/// analysis that has residuals.
NamedFigure figure_residuals(const ResponseAnalysis& analysis, const std::string& name);

/// Bytes of the caches of a geometry unit: 8, 64 and 512 lines for levels 0, 1 and 2, `lines` for
/// each deeper one, a word of 2 bytes in each. Tags are not counted.
double unit_cache_bytes(std::uint32_t depth, std::uint64_t lines);

/// Bytes of a geometry unit's cache lines that were ever filled, the mean over units.
double used_cache_bytes(const ExperimentCell& cell);

}  // namespace relumbre
