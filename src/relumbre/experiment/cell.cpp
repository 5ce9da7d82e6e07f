#include "relumbre/experiment/cell.h"

#include "relumbre/archsim/metrics.h"

namespace relumbre {

std::uint64_t cell_reads(const ExperimentCell& cell) {
  std::uint64_t reads = 0;
  for (const CellLevel& level : cell.levels) reads += level.reads;
  return reads;
}

std::uint64_t cell_fetches(const ExperimentCell& cell) {
  std::uint64_t fetches = 0;
  for (const CellLevel& level : cell.levels) fetches += level.reads - level.hits;
  return fetches;
}

double cell_hit_rate(const ExperimentCell& cell) {
  const std::uint64_t reads = cell_reads(cell);
  return hit_rate(reads - cell_fetches(cell), reads);
}

double level_hit_rate(const CellLevel& level) { return hit_rate(level.hits, level.reads); }

std::string cell_resolution(const ExperimentCell& cell) {
  return std::to_string(cell.width) + "x" + std::to_string(cell.height);
}

}  // namespace relumbre
