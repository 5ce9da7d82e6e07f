/// Cells as a table that other programs read.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relumbre/experiment/cell.h"

namespace relumbre {

/// One line a cell after a line of names: scene, depth, width, height, traversal, gts, tile, lines,
/// tasks, reads, M, L, and for every level n: reads_n, hits_n, replacements_n, lines_used_n, empty
/// beyond a cell's depth. Names are quoted where they must be. L is written so that it reads back
/// as the same double.
std::string cells_to_csv(std::span<const ExperimentCell> cells);

/// Reads what cells_to_csv wrote, exactly. Throws FileError "FILE:LINE: reason": another header, a
/// number that is none, more hits than reads, sums that are not those of the levels, a text beyond
/// 1 GiB.
std::vector<ExperimentCell> parse_cells_csv(std::string_view text, const std::string& file);
std::vector<ExperimentCell> read_cells_csv(const std::filesystem::path& file);

}  // namespace relumbre
