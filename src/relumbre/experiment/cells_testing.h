/// Made-up cells that look like those of a machine. For tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "relumbre/experiment/cell.h"

namespace relumbre {

struct CellGrid {
  std::vector<std::string> scenes{"teapot", "bunny", "dragon", "Happy Buddha"};
  std::vector<std::uint32_t> depths{5, 6, 7, 8, 9, 10}, tiles{2, 10, 20, 40};
  std::vector<std::uint64_t> lines{512, 4096, 32768, 262144};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> resolutions{
      {640, 480}, {800, 600}, {1280, 720}, {1920, 1080}, {3200, 1800}};
};

/// A level of 8^n addresses of which about 4^n are touched; caches that are too small miss again.
inline CellLevel made_up_level(double rays, double cover, std::uint32_t n, double lines,
                               double tile) {
  const double nodes = std::min(rays, cover * std::pow(4.0, n));
  const double reads = rays * (n == 0 ? 1 : cover * (1 + 0.1 * n));
  const double spill = nodes > lines ? 0.1 * (1 - lines / nodes) * (1 + 0.02 / tile) : 0;
  const double misses = std::min(reads, std::ceil(nodes + reads * spill));
  CellLevel level;
  level.reads = static_cast<std::uint64_t>(reads);
  level.hits = level.reads - std::min(level.reads, static_cast<std::uint64_t>(misses));
  level.lines_used = static_cast<std::uint64_t>(std::min(nodes, lines));
  level.replacements =
      level.reads - level.hits - std::min(level.reads - level.hits, level.lines_used);
  return level;
}

inline ExperimentCell made_up_cell(ExperimentCell cell, double cover) {
  constexpr double kUpper[] = {8, 64, 512};
  const double rays = static_cast<double>(cell.width) * cell.height;
  for (std::uint32_t n = 0; n < cell.depth; ++n) {
    const double lines = n < 3 ? kUpper[n] : static_cast<double>(cell.lines);
    cell.levels.push_back(made_up_level(rays, cover, n, lines, cell.tile));
    cell.tasks += 3 * cell.levels.back().reads;
  }
  return cell;
}

inline std::vector<ExperimentCell> made_up_cells(const CellGrid& grid = {}) {
  std::vector<ExperimentCell> cells;
  for (std::size_t s = 0; s < grid.scenes.size(); ++s)
    for (const std::uint32_t depth : grid.depths)
      for (const auto& [width, height] : grid.resolutions)
        for (const std::uint32_t tile : grid.tiles)
          for (const std::uint64_t lines : grid.lines) {
            const ExperimentCell cell{grid.scenes[s], "gt",  depth, width, height, 8,
                                      tile,           lines, 0,     {}};
            cells.push_back(made_up_cell(cell, 0.3 + 0.07 * static_cast<double>(s)));
          }
  return cells;
}

}  // namespace relumbre
