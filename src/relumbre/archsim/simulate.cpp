#include "relumbre/archsim/simulate.h"

#include "relumbre/archsim/replay.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

HierarchyConfig hierarchy_of(const Trace& trace, const MachineConfig& config, std::uint32_t unit) {
  return {.levels = trace.shape().levels,
          .lines = config.lines,
          .ways = config.ways,
          .replacement = config.replacement,
          .seed = hash64(config.seed, unit),
          .classify = config.classify};
}

UnitCounters simulate_unit(const Trace& trace, const Tiles& tiles, const MachineConfig& config,
                           std::uint32_t unit) {
  UnitCounters counters;
  if (tiles.owned_by(unit).is_empty()) return counters;
  MemoryHierarchy memory(hierarchy_of(trace, config, unit));
  PathDecoder decode;
  replay(trace, tiles, unit, [&](const TraceRun& run) {
    counters.rays += run.rays;
    counters.tasks += run.tasks;
    for (const std::uint8_t byte : run.reads) {
      const auto read = decode(byte);
      memory.read(static_cast<int>(read.level), read.address);
    }
  });
  counters.levels = memory.counters();
  counters.classes = memory.classes();
  return counters;
}

}  // namespace

Simulation simulate(const Trace& trace, const MachineConfig& config) {
  const Tiles tiles(trace.shape().width, trace.shape().height, config.tile, config.gts);
  Simulation result;
  result.units.resize(config.gts);
  parallel_for(0, result.units.size(), 1, [&](std::size_t unit) {
    result.units[unit] = simulate_unit(trace, tiles, config, static_cast<std::uint32_t>(unit));
  });
  for (const UnitCounters& unit : result.units) result.total += unit;
  return result;
}

}  // namespace relumbre
