#include "relumbre/archsim/simulate.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/archsim/trace_testing.h"
#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {
namespace {

using namespace archsim_testing;

TEST(Simulate, APixelByHand) {
  // Two rays: root 1, 8, 64 of them twice; level 2 has 512 lines, level 3 one line.
  const RayReads ray{.tasks = 5, .reads = {{0, 1}, {1, 8}, {2, 64}, {3, 512}, {3, 513}}};
  const Simulation result =
      simulate(record({2, 1, 4}, {ray, ray}), {.tile = 2, .lines = 1, .classify = true});
  const std::vector<CacheCounters> expected{{2, 1, 0, 1}, {2, 1, 0, 1}, {2, 1, 0, 1}, {4, 0, 3, 1}};
  EXPECT_EQ(result.total.levels, expected);
  EXPECT_EQ(result.total.classes[3], (MissClasses{2, 2, 0}));
  const MachineMetrics metrics = metrics_of(result.total);
  EXPECT_EQ(metrics.reads, 10U);
  EXPECT_EQ(metrics.tasks, 10U);
  EXPECT_EQ(metrics.proposed.fetches, 7U);
  EXPECT_EQ(metrics.proposed.bytes, 14U);
  EXPECT_DOUBLE_EQ(metrics.proposed.hit_rate, 0.3);
  EXPECT_EQ(metrics.naive_word.fetches, 10U);
  EXPECT_EQ(metrics.naive_word.bytes, 20U);
  EXPECT_EQ(metrics.naive_pointer.fetches, 10U);
  EXPECT_EQ(metrics.naive_pointer.bytes, 320U);
}

TEST(Simulate, NothingReadHasAHitRateOfZero) {
  const Simulation result = simulate(record({3, 2, 4}, std::vector<RayReads>(6)), {});
  const MachineMetrics metrics = metrics_of(result.total);
  EXPECT_EQ(metrics.reads, 0U);
  EXPECT_EQ(metrics.proposed.hit_rate, 0.0);
  EXPECT_EQ(hit_rate(result.total.levels[0]), 0.0);
}

void expect_one_pass_to_be_many(const Trace& trace, MachineConfig config,
                                const std::vector<std::uint64_t>& lines) {
  const auto all = simulate_lines(trace, config, lines);
  ASSERT_EQ(all.size(), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    config.lines = lines[i];
    ASSERT_EQ(all[i], simulate(trace, config))
        << trace.shape().levels << " levels, " << config.gts << " units, tile " << config.tile
        << ", " << lines[i] << " lines";
  }
}

TEST(Simulate, OnePassOverAllSizesCountsWhatAPassForEachDoes) {
  for (const int levels : {1, 3, 6, 9, 12, kMaxTraceLevels}) {
    const Trace trace = random_trace({45, 31, levels}, static_cast<std::uint64_t>(levels));
    for (const std::uint32_t gts : {1U, 2U, 3U, 7U})
      for (const std::uint32_t tile : {1U, 2U, 10U, 40U, 100U})
        expect_one_pass_to_be_many(trace, {.gts = gts, .tile = tile}, {4096, 1, 64, 512, 64});
    expect_one_pass_to_be_many(trace, {.gts = 2}, {262'144, 32'768});
  }
}

TEST(Simulate, ThereMayBeMoreUnitsThanTiles) {
  const Trace trace = random_trace({45, 31, 6}, 1);
  expect_one_pass_to_be_many(trace, {.gts = 2000, .tile = 1}, {64, 8});
  expect_one_pass_to_be_many(trace, {.gts = 5, .tile = 100}, {64, 8});
}

TEST(Simulate, EveryReadAndTaskBelongsToAUnit) {
  const Trace trace = random_trace({33, 21, 6}, 1);
  std::uint64_t tasks = 0;
  for (const std::uint32_t count : trace.tasks()) tasks += count;
  for (const std::uint32_t gts : {1U, 3U, 100U}) {
    const Simulation result = simulate(trace, {.gts = gts, .tile = 4});
    EXPECT_EQ(result.units.size(), gts);
    EXPECT_EQ(result.total.rays, 33U * 21);
    EXPECT_EQ(result.total.tasks, tasks);
    EXPECT_EQ(metrics_of(result.total).reads, trace.reads().size());
  }
}

TEST(Simulate, ALevelThatCannotConflictMissesEachAddressOnce) {
  const TraceShape shape{33, 21, 7};
  const auto rays = random_rays(shape, 2);
  const Simulation result = simulate(record(shape, rays), {.lines = 4096, .classify = true});
  std::vector<std::set<std::uint64_t>> distinct(7);
  for (const RayReads& ray : rays)
    for (const Read& read : ray.reads)
      distinct[static_cast<std::size_t>(read.level)].insert(read.address);
  for (std::size_t level = 0; level <= 4; ++level) {
    EXPECT_EQ(result.total.levels[level].misses(), distinct[level].size());
    EXPECT_EQ(result.total.classes[level], (MissClasses{distinct[level].size(), 0, 0}));
  }
  EXPECT_GT(result.total.levels[6].misses(), distinct[6].size());
}

TEST(Simulate, ClassesAddUpToMisses) {
  const Trace trace = random_trace({33, 21, 7}, 3);
  for (const std::uint64_t ways : {0U, 1U, 4U})
    for (const Replacement replacement :
         {Replacement::kLru, Replacement::kFifo, Replacement::kRandom}) {
      const MachineConfig config{
          .gts = 3, .lines = 64, .ways = ways, .replacement = replacement, .classify = true};
      const Simulation result = simulate(trace, config);
      for (std::size_t level = 0; level < 7; ++level)
        EXPECT_EQ(result.total.classes[level].sum(), result.total.levels[level].misses());
    }
}

TEST(Simulate, ClassifyingChangesNoCount) {
  const Trace trace = random_trace({33, 21, 7}, 4);
  MachineConfig config{.gts = 2, .lines = 64, .ways = 8, .replacement = Replacement::kRandom};
  const Simulation plain = simulate(trace, config);
  config.classify = true;
  EXPECT_EQ(simulate(trace, config).total.levels, plain.total.levels);
}

TEST(Simulate, LargerDirectMappedCachesNeverMissMore) {
  const Trace trace = random_trace({45, 31, 9}, 5);
  const auto all = simulate_lines(trace, {.gts = 2}, std::vector<std::uint64_t>{8, 64, 512, 4096});
  for (std::size_t i = 1; i < all.size(); ++i)
    for (std::size_t level = 0; level < 9; ++level)
      EXPECT_LE(all[i].total.levels[level].misses(), all[i - 1].total.levels[level].misses());
}

TEST(Simulate, ThreadsDoNotChangeTheCounts) {
  const Trace trace = random_trace({45, 31, 9}, 6);
  const MachineConfig config{.gts = 5, .ways = 2, .replacement = Replacement::kRandom};
  const Simulation many = simulate(trace, config);
  const ThreadLimit one(1);
  EXPECT_EQ(simulate(trace, config), many);
}

TEST(Simulate, RefusesMachinesThatCannotBeBuilt) {
  const Trace trace = random_trace({3, 2, 4}, 1);
  EXPECT_THROW(simulate(trace, {.gts = 0}), ValueError);
  EXPECT_THROW(simulate(trace, {.tile = 0}), ValueError);
  EXPECT_THROW(simulate(trace, {.lines = 0}), ValueError);
  EXPECT_THROW(simulate(trace, {.lines = 100, .ways = 3}), ValueError);
  const std::vector<std::uint64_t> sizes{512};
  EXPECT_THROW(simulate_lines(trace, {.ways = 2}, sizes), ValueError);
  EXPECT_THROW(simulate_lines(trace, {.classify = true}, sizes), ValueError);
  EXPECT_THROW(simulate_lines(trace, {}, std::vector<std::uint64_t>{500}), ValueError);
  EXPECT_THROW(simulate_lines(trace, {}, std::vector<std::uint64_t>{0}), ValueError);
  EXPECT_TRUE(simulate_lines(trace, {}, {}).empty());
}

TEST(Metrics, SumsNeedTheSameLevels) {
  UnitCounters a{.levels = std::vector<CacheCounters>(2)},
      b{.levels = std::vector<CacheCounters>(3)};
  EXPECT_THROW(a += b, ShapeError);
  EXPECT_NO_THROW(a += UnitCounters{});
}

}  // namespace
}  // namespace relumbre
