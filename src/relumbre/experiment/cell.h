/// What one cell of an experiment measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace relumbre {

/// The caches of one level of the octree, summed over the geometry units.
struct CellLevel {
  std::uint64_t reads = 0, hits = 0, replacements = 0, lines_used = 0;
  friend bool operator==(const CellLevel&, const CellLevel&) = default;
};

struct ExperimentCell {
  // The levels of the factors.
  std::string scene, traversal;
  std::uint32_t depth = 0, width = 0, height = 0, gts = 1, tile = 0;
  std::uint64_t lines = 0;
  // What was counted.
  std::uint64_t tasks = 0;        ///< popped, over all units
  std::vector<CellLevel> levels;  ///< `depth` of them, the root's first

  friend bool operator==(const ExperimentCell&, const ExperimentCell&) = default;
};

std::uint64_t cell_reads(
    const ExperimentCell& cell);  ///< words asked for: M of a machine without caches
std::uint64_t cell_fetches(const ExperimentCell& cell);  ///< M: words fetched, Σ (reads − hits)
double cell_hit_rate(const ExperimentCell& cell);  ///< L = Σ hits / Σ reads; 0 without reads
double level_hit_rate(const CellLevel& level);

/// "640x480"
std::string cell_resolution(const ExperimentCell& cell);

}  // namespace relumbre
