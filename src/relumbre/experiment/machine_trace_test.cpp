#include "relumbre/experiment/machine_trace.h"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/archsim/simulate.h"
#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/experiment/slow_machine.h"
#include "relumbre/octree/test_voxels.h"

namespace relumbre {
namespace {

using namespace test;
using experiment_testing::SlowMachine;
using Kind = Traversal::Kind;

struct Sight {
  VoxelSet voxels;
  int depth;
  std::uint32_t width, height;
  Camera camera;
};

/// The cube is [0, 1]³. Some look along an axis from a plane of cells: 0/0 in the slabs.
std::vector<Sight> sights() {
  const Camera outside{.eye = {1.9F, 1.3F, 2.2F}, .target = {0.5F, 0.5F, 0.5F}};
  const Camera inside{.eye = {0.51F, 0.52F, 0.53F}, .target = {0, 0.2F, 1}, .vfov_deg = 90};
  const Camera axis{.eye = {0.5F, 0.5F, -1}, .target = {0.5F, 0.5F, 0}, .vfov_deg = 60};
  const Camera edge{.eye = {-0.5F, 1, 0.25F}, .target = {1, 1, 0.25F}, .vfov_deg = 40};
  return {{random_voxels(1, 4, 1), 1, 1, 1, outside},
          {random_voxels(3, 40, 2), 3, 7, 5, inside},
          {random_voxels(4, 300, 3), 4, 21, 13, axis},
          {random_voxels(5, 500, 4), 5, 33, 9, edge},
          {shell(6), 6, 37, 23, outside},
          {shell(4), 4, 10, 31, inside},
          {random_voxels(7, 3000, 5), 7, 23, 41, outside},
          {{}, 3, 6, 4, outside}};
}

Cube unit_cube() { return {{0, 0, 0}, 1}; }

Trace trace_of(const Sight& sight, const std::optional<Traversal>& traversal = {}) {
  return machine_trace(Octree(sight.voxels, sight.depth), unit_cube(), sight.camera,
                       {sight.width, sight.height, traversal});
}

TEST(MachineTrace, SimulatedIsWhatADirectTranscriptionOfTheDefinitionCounts) {
  const std::vector<std::uint64_t> lines{8, 64, 512, 4096, 32'768, 262'144};
  for (const Sight& sight : sights()) {
    const Trace trace = trace_of(sight);
    const GridRays rays(unit_cube(), static_cast<unsigned>(sight.depth), sight.camera, sight.width,
                        sight.height);
    for (const std::uint32_t gts : {1U, 2U, 3U, 7U})
      for (const std::uint32_t tile : {1U, 2U, 10U, 20U, 40U}) {
        MachineConfig config{.gts = gts, .tile = tile};
        const auto all = simulate_lines(trace, config, lines);
        for (std::size_t i = 0; i < lines.size(); ++i) {
          config.lines = lines[i];
          SlowMachine slow(sight.voxels, sight.depth, gts, lines[i]);
          slow.draw(rays, sight.width, sight.height, tile);
          ASSERT_EQ(all[i], slow.simulation())
              << "depth " << sight.depth << ", " << gts << " units, tile " << tile << ", "
              << lines[i] << " lines";
          if (lines[i] > 4096) continue;  // much memory to clear
          ASSERT_EQ(simulate(trace, config), slow.simulation());
        }
      }
  }
}

TEST(MachineTrace, ALevelThatCannotConflictMissesTheDistinctNodesTouched) {
  for (const Sight& sight : sights()) {
    const Trace trace = trace_of(sight);
    std::vector<std::set<std::uint64_t>> touched(static_cast<std::size_t>(sight.depth));
    PathDecoder decode;
    for (const std::uint8_t byte : trace.reads()) {
      const auto read = decode(byte);
      touched[read.level].insert(read.address);
    }
    const Simulation result = simulate(trace, {.tile = 3, .lines = 262'144});
    for (std::size_t level = 0; level < touched.size() && level <= 6; ++level) {
      EXPECT_EQ(result.total.levels[level].misses(), touched[level].size());
      EXPECT_EQ(result.total.levels[level].lines_used, touched[level].size());
      EXPECT_EQ(result.total.levels[level].replacements, 0U);
    }
  }
}

TEST(MachineTrace, TileSizeDoesNotMatterOnceNoLevelConflicts) {
  // Depth 6: levels 0 to 5, the last of 8⁵ addresses.
  const Sight sight = sights()[4];
  const Trace trace = trace_of(sight);
  std::set<std::uint64_t> fetched;
  for (const std::uint32_t tile : {1U, 2U, 10U, 20U, 40U})
    fetched.insert(
        metrics_of(simulate(trace, {.tile = tile, .lines = 32'768}).total).proposed.fetches);
  EXPECT_EQ(fetched.size(), 1U);
}

TEST(MachineTrace, ARayPopsEachChildOfTheNodesThatItReadAtMostOnce) {
  for (const Sight& sight : sights()) {
    const Trace trace = trace_of(sight);
    for (std::size_t pixel = 0; pixel < trace.shape().pixels(); ++pixel) {
      EXPECT_GE(trace.tasks()[pixel], 1U);
      EXPECT_GE(trace.tasks()[pixel], trace.read_counts()[pixel]);
      EXPECT_LE(trace.tasks()[pixel], 1 + 8 * trace.read_counts()[pixel]);
    }
  }
}

/// Counts what a traversal tells.
struct Counts {
  std::uint32_t tasks = 0;
  std::vector<std::uint8_t> reads;
  void begin_ray(const GridRay&) {}
  void visit(LocationCode, int) { ++tasks; }
  void read(LocationCode code, int level) { reads.push_back(pack_read(level, octant_of(code))); }
  void restart() {}
};

TEST(MachineTrace, AnyTraversalOfTheSurveyIsRecorded) {
  const Sight sight = sights()[6];
  const Octree octree(sight.voxels, sight.depth);
  const GridRays rays(unit_cube(), static_cast<unsigned>(sight.depth), sight.camera, sight.width,
                      sight.height);
  for (const Traversal& traversal :
       {Traversal{Kind::kRestart}, Traversal{Kind::kBacktrack}, Traversal{Kind::kFullStack},
        Traversal{Kind::kShortStack, 1}, Traversal{Kind::kShortStack, 3}}) {
    const Trace recorded = trace_of(sight, traversal);
    std::vector<std::uint8_t> reads;
    for (std::uint32_t y = 0; y < sight.height; ++y)
      for (std::uint32_t x = 0; x < sight.width; ++x) {
        Counts counts;
        const auto ray = rays.through_center(x, y);
        (void)trace(octree, GridRay(ray.origin, ray.direction), traversal, counts);
        ASSERT_EQ(recorded.tasks()[y * std::size_t{sight.width} + x], counts.tasks);
        reads.insert(reads.end(), counts.reads.begin(), counts.reads.end());
      }
    ASSERT_TRUE(std::ranges::equal(recorded.reads(), reads));
  }
}

TEST(MachineTrace, ThreadsDoNotChangeIt) {
  const Sight sight = sights()[4];
  const Trace many = trace_of(sight);
  const ThreadLimit one(1);
  const Trace single = trace_of(sight);
  EXPECT_TRUE(std::ranges::equal(single.reads(), many.reads()));
  EXPECT_TRUE(std::ranges::equal(single.tasks(), many.tasks()));
  EXPECT_TRUE(std::ranges::equal(single.read_counts(), many.read_counts()));
}

TEST(MachineTrace, RefusesWhatCannotBe) {
  Sight sight = sights()[1];
  EXPECT_THROW(trace_of(sight, Traversal{Kind::kShortStack, 0}), ValueError);
  sight.width = 0;
  EXPECT_THROW(trace_of(sight), ValueError);
  sight.width = TraceShape::kMaxSide + 1;
  EXPECT_THROW(trace_of(sight), ValueError);
}

struct Stopped : Progress {
  [[nodiscard]] bool cancelled() const override { return true; }
};

TEST(MachineTrace, StopsWhenAskedTo) {
  const Sight sight = sights()[1];
  Stopped stopped;
  EXPECT_THROW(machine_trace(Octree(sight.voxels, sight.depth), unit_cube(), sight.camera,
                             {sight.width, sight.height}, stopped),
               Cancelled);
}

}  // namespace
}  // namespace relumbre
