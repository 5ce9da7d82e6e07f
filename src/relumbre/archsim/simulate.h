/// The simulated machine: G geometry units with a memory hierarchy each, cold when the picture
/// begins and kept from tile to tile, work through a trace.
///
///   trace ──► tiles ──► unit 0: reads in its order ──► caches of levels 0, 1, 2, ... ──► counters
///                 └───► unit 1 ...
///
/// The order of the pixels is all that G and T change; a ray asks for the same words whoever traces
/// it. Units share nothing, so they are simulated in parallel, and the counts are the same for any
/// number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/archsim/memory_hierarchy.h"
#include "relumbre/archsim/metrics.h"
#include "relumbre/archsim/trace.h"

namespace relumbre {

struct MachineConfig {
  std::uint32_t gts = 1;       ///< geometry units
  std::uint32_t tile = 20;     ///< T: pixels a side
  std::uint64_t lines = 4096;  ///< L, of the caches of levels 3 and deeper
  std::uint64_t ways = 1;      ///< 1: direct-mapped; 0: fully associative
  Replacement replacement = Replacement::kLru;
  std::uint64_t seed = 1;  ///< of Replacement::kRandom
  bool classify = false;   ///< count compulsory, capacity and conflict misses
};

struct Simulation {
  UnitCounters total;
  std::vector<UnitCounters> units;
  friend bool operator==(const Simulation&, const Simulation&) = default;
};

/// Any machine, one read after the other through its caches. Throws ValueError for a machine that
/// cannot be built.
Simulation simulate(const Trace& trace, const MachineConfig& config);

/// Direct-mapped machines that differ in L alone, all in one pass, and the same counts as
/// simulate()'s. `config.lines` is not used. Throws ValueError where an L is no power of two or the
/// caches are not direct-mapped, or are to be classified.
///
/// The smaller cache's index is the low part of the larger one's, so that whatever the smaller one
/// holds (the last address of each of its sets) the larger one holds, too: inclusion. Hence the
/// smallest is asked first, and after a hit nothing larger needs to be looked at, nor changed.
///
///   level     L = 512     4096    32768   262144
///   3          [512]───────────────────────────►    as many lines as there are addresses: from
///   4          [512] ──► [4096]────────────────►    there on all caches have the same counts
///   5          [512] ──► [4096] ─► [32768]─────►
///   6 ...      [512] ──► [4096] ─► [32768] ─► [262144]
///
/// Source: Mattson et al. 1970; for direct-mapped caches Hill and Smith 1989, "forest simulation".
/// Memory: 4 bytes a line, level and unit at work (8 beyond 11 levels).
std::vector<Simulation> simulate_lines(const Trace& trace, const MachineConfig& config,
                                       std::span<const std::uint64_t> lines);

}  // namespace relumbre
