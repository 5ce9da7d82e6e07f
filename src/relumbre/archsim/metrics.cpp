#include "relumbre/archsim/metrics.h"

#include <cstddef>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

/// Level by level.
template <class Counters>
void add(std::vector<Counters>& sum, const std::vector<Counters>& other) {
  if (other.empty()) return;
  if (sum.empty()) sum.resize(other.size());
  if (sum.size() != other.size())
    throw ShapeError(fmt::format("counters of {} levels cannot be added to those of {}",
                                 other.size(), sum.size()));
  for (std::size_t level = 0; level < sum.size(); ++level) sum[level] += other[level];
}

}  // namespace

UnitCounters& UnitCounters::operator+=(const UnitCounters& other) {
  rays += other.rays;
  tasks += other.tasks;
  add(levels, other.levels);
  add(classes, other.classes);
  return *this;
}

double hit_rate(std::uint64_t hits, std::uint64_t reads) {
  return reads == 0 ? 0 : static_cast<double>(hits) / static_cast<double>(reads);
}

double hit_rate(const CacheCounters& counters) { return hit_rate(counters.hits, counters.reads); }

MachineMetrics metrics_of(const UnitCounters& total) {
  CacheCounters sum;
  for (const CacheCounters& level : total.levels) sum += level;
  return {.reads = sum.reads,
          .tasks = total.tasks,
          .proposed = {sum.misses(), sum.misses() * kWordBytes, hit_rate(sum)},
          .naive_word = {sum.reads, sum.reads * kWordBytes, 0},
          .naive_pointer = {total.tasks, total.tasks * kRecordBytes, 0}};
}

}  // namespace relumbre
