#include "relumbre/octree/traversal_observer.h"

#include <algorithm>
#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/octree/test_rays.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/traversal_testing.h"
#include "relumbre/octree/traverse.h"

namespace relumbre {
namespace {

using test::all_traversals, test::name_of, test::random_voxels, test::shell, test::test_rays,
    test::TestRay, test::VoxelSet;
using Kind = Traversal::Kind;

/// What an observer hears.
struct Log {
  std::size_t rays = 0, restarts = 0;
  std::vector<LocationCode> visits, reads;

  void begin_ray(const GridRay&) { ++rays; }
  void visit(LocationCode code, int level) { add(visits, code, level); }
  void read(LocationCode code, int level) { add(reads, code, level); }
  void restart() { ++restarts; }

 private:
  static void add(std::vector<LocationCode>& list, LocationCode code, int level) {
    EXPECT_EQ(level_of(code), level);
    list.push_back(code);
  }
};

/// The nodes of a tree as a sorted list of codes, and traversals that are written for clarity
/// alone.
class SlowTwin {
 public:
  SlowTwin(const VoxelSet& voxels, int depth) : depth_(depth) {
    for (const std::uint64_t voxel : voxels)
      for (LocationCode code = location_code(depth, voxel); code != 0; code = parent_of(code))
        nodes_.push_back(code);
    std::sort(nodes_.begin(), nodes_.end());
  }

  /// The full stack by recursion. Whether the ray ends in this node.
  bool full_stack(const GridRay& ray, LocationCode code, Log& log) const {
    log.visit(code, level_of(code));
    if (!interval(ray, code).is_pierced()) return false;
    if (level_of(code) == depth_) return true;
    log.read(code, level_of(code));
    for (unsigned rank = 0; rank < 8; ++rank) {
      const LocationCode child = child_of(code, rank ^ ray.sign_mask());
      if (has(child) && full_stack(ray, child, log)) return true;
    }
    return false;
  }

  /// A stack of the last `remembered` nodes read; 0 of them make a restart.
  void short_stack(const GridRay& ray, std::size_t remembered, Log& log) const {
    log.visit(kRootCode, 0);
    const RayInterval root = interval(ray, kRootCode);
    if (!root.is_pierced()) return;
    std::deque<LocationCode> last;
    const auto read = [&](LocationCode code) {
      log.read(code, level_of(code));
      last.push_back(code);
      if (last.size() > remembered) last.pop_front();
    };
    read(kRootCode);
    LocationCode node = kRootCode;
    for (double now = root.enter;;) {
      while (has(node) && level_of(node) < depth_) {
        if (node = child_at(ray, node, now); has(node) && level_of(node) < depth_) read(node);
        log.visit(node, level_of(node));
      }
      if (has(node)) return;
      now = interval(ray, node).exit;
      if (now >= root.exit) return;
      for (node = 0; node == 0 && !last.empty();) {
        log.visit(last.back(), level_of(last.back()));
        if (now < interval(ray, last.back()).exit)
          node = last.back();
        else
          last.pop_back();
      }
      if (node != 0) continue;
      log.restart();
      node = kRootCode;
      read(node);
    }
  }

 private:
  [[nodiscard]] bool has(LocationCode code) const {
    return std::binary_search(nodes_.begin(), nodes_.end(), code);
  }
  [[nodiscard]] RayInterval interval(const GridRay& ray, LocationCode code) const {
    const int up = depth_ - level_of(code);
    const Cell cell = cell_of(code);
    return ray.interval({cell.x << up, cell.y << up, cell.z << up}, 1U << up);
  }
  [[nodiscard]] LocationCode child_at(const GridRay& ray, LocationCode code, double now) const {
    for (unsigned octant = 0; octant < 8; ++octant) {
      const RayInterval part = interval(ray, child_of(code, octant));
      if (part.enter <= now && now < part.exit) return child_of(code, octant);
    }
    ADD_FAILURE() << "no octant of " << code << " holds the ray at " << now;
    return 0;
  }

  int depth_;
  std::vector<LocationCode> nodes_;
};

struct Scene {
  VoxelSet voxels;
  int depth;
};

std::vector<Scene> scenes() {
  return {{shell(6), 6}, {random_voxels(5, 400, 1), 5}, {random_voxels(8, 900, 2), 8}, {{0}, 1}};
}

Log log_of(const Octree& octree, const TestRay& ray, const Traversal& traversal) {
  Log log;
  (void)trace(octree, GridRay(ray.origin, ray.direction), traversal, log);
  EXPECT_EQ(log.rays, 1U);
  return log;
}

TEST(Observer, HearsOfTheFullStackWhatARecursionDoes) {
  for (const auto& [voxels, depth] : scenes()) {
    const Octree octree(voxels, depth);
    const SlowTwin twin(voxels, depth);
    for (const TestRay& ray : test_rays(depth, 2000)) {
      const Log log = log_of(octree, ray, {Kind::kFullStack});
      Log expected;
      twin.full_stack(GridRay(ray.origin, ray.direction), kRootCode, expected);
      ASSERT_EQ(log.visits, expected.visits);
      ASSERT_EQ(log.reads, expected.reads);
      ASSERT_EQ(log.restarts, 0U);
    }
  }
}

TEST(Observer, HearsOfShortStacksAndRestartWhatASlowOneDoes) {
  for (const auto& [voxels, depth] : scenes()) {
    const Octree octree(voxels, depth);
    const SlowTwin twin(voxels, depth);
    for (const TestRay& ray : test_rays(depth, 1000))
      for (int nodes = 0; nodes <= depth; ++nodes) {
        const Log log =
            log_of(octree, ray,
                   nodes == 0 ? Traversal{Kind::kRestart} : Traversal{Kind::kShortStack, nodes});
        Log expected;
        twin.short_stack(GridRay(ray.origin, ray.direction), static_cast<std::size_t>(nodes),
                         expected);
        ASSERT_EQ(log.visits, expected.visits) << nodes;
        ASSERT_EQ(log.reads, expected.reads) << nodes;
        ASSERT_EQ(log.restarts, expected.restarts) << nodes;
      }
  }
}

TEST(Observer, AShortStackAsDeepAsTheTreeReadsWhatTheFullStackReads) {
  for (const auto& [voxels, depth] : scenes()) {
    const Octree octree(voxels, depth);
    for (const TestRay& ray : test_rays(depth, 2000)) {
      const Log full = log_of(octree, ray, {Kind::kFullStack});
      const Log deep = log_of(octree, ray, {Kind::kShortStack, depth});
      ASSERT_EQ(deep.reads, full.reads);
      ASSERT_EQ(deep.restarts, 0U);
    }
  }
}

std::vector<LocationCode> distinct(std::vector<LocationCode> codes) {
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

TEST(Observer, EveryKindReadsTheSameNodesSomeMoreOften) {
  for (const auto& [voxels, depth] : scenes()) {
    const Octree octree(voxels, depth);
    for (const TestRay& ray : test_rays(depth, 1000)) {
      const auto nodes = distinct(log_of(octree, ray, {Kind::kFullStack}).reads);
      for (const Traversal& traversal : all_traversals())
        ASSERT_EQ(distinct(log_of(octree, ray, traversal).reads), nodes) << name_of(traversal);
    }
  }
}

TEST(Observer, MoreMemoryNeverReadsMore) {
  std::size_t saved = 0;
  for (const auto& [voxels, depth] : scenes()) {
    const Octree octree(voxels, depth);
    for (const TestRay& ray : test_rays(depth, 1000)) {
      std::size_t more = log_of(octree, ray, {Kind::kRestart}).reads.size();
      const std::size_t backtrack = log_of(octree, ray, {Kind::kBacktrack}).reads.size();
      ASSERT_LE(backtrack, more);
      for (int nodes = 1; nodes <= depth; ++nodes) {
        const Log log = log_of(octree, ray, {Kind::kShortStack, nodes});
        ASSERT_LE(log.reads.size(), more);
        saved += more - log.reads.size();
        more = log.reads.size();
      }
      ASSERT_LE(more, backtrack);
    }
  }
  EXPECT_GT(saved, 0U);
}

TEST(Observer, RestartReadsTheRootOnceMoreThanItRestarts) {
  const Octree octree(shell(6), 6);
  for (const TestRay& ray : test_rays(6, 1000)) {
    const Log log = log_of(octree, ray, {Kind::kRestart});
    const auto roots = std::count(log.reads.begin(), log.reads.end(), kRootCode);
    ASSERT_EQ(static_cast<std::size_t>(roots), log.reads.empty() ? 0 : log.restarts + 1);
  }
}

}  // namespace
}  // namespace relumbre
