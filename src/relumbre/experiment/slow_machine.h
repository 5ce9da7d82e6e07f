/// The simulated machine as its definition says it, for the tests: nothing is stored between the
/// ray and the cache, nothing is fast, and nothing is shared with what it is compared with but the
/// rays.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "relumbre/archsim/simulate.h"
#include "relumbre/experiment/machine_trace.h"
#include "relumbre/render/grid_rays.h"

namespace relumbre::experiment_testing {

/// Direct-mapped: a line holds one code.
class SlowCache {
 public:
  explicit SlowCache(std::uint64_t lines) : lines_(lines) {}
  void read(std::uint64_t code) {
    ++counters_.reads;
    const auto line = content_.find(code % lines_);
    if (line == content_.end()) {
      ++counters_.lines_used;
      content_[code % lines_] = code;
    } else if (line->second == code) {
      ++counters_.hits;
    } else {
      ++counters_.replacements;
      line->second = code;
    }
  }
  [[nodiscard]] const CacheCounters& counters() const { return counters_; }

 private:
  std::uint64_t lines_;
  std::map<std::uint64_t, std::uint64_t> content_;
  CacheCounters counters_;
};

class SlowMachine {
 public:
  SlowMachine(const std::vector<std::uint64_t>& voxels, int depth, std::uint32_t gts,
              std::uint64_t lines)
      : depth_(depth), units_(gts) {
    nodes_.insert(1);
    for (const std::uint64_t voxel : voxels)
      for (int level = 1; level <= depth; ++level)
        nodes_.insert((std::uint64_t{1} << 3 * level) + (voxel >> 3 * (depth - level)));
    for (Unit& unit : units_)
      for (int level = 0; level < depth; ++level)
        unit.caches.emplace_back(level == 0 ? 8 : level == 1 ? 64 : level == 2 ? 512 : lines);
  }

  /// Every tile by the unit that owns it.
  void draw(const GridRays& rays, std::uint32_t width, std::uint32_t height, std::uint32_t tile) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> corners;
    for (std::uint32_t y = 0; y < height; y += tile)
      for (std::uint32_t x = 0; x < width; x += tile) corners.emplace_back(x, y);
    const std::size_t n = corners.size(), g = units_.size();
    for (std::size_t unit = 0; unit < g; ++unit)
      for (std::size_t i = unit * n / g; i < (unit + 1) * n / g; ++i)
        for (std::uint32_t y = corners[i].second; y < std::min(corners[i].second + tile, height);
             ++y)
          for (std::uint32_t x = corners[i].first; x < std::min(corners[i].first + tile, width);
               ++x)
            trace(units_[unit], rays.through_center(x, y));
  }

  [[nodiscard]] Simulation simulation() const {
    Simulation result;
    result.total.levels.resize(static_cast<std::size_t>(depth_));
    for (const Unit& unit : units_) {
      UnitCounters counters{.rays = unit.rays, .tasks = unit.tasks};
      // A unit without pixels has no counts.
      for (const SlowCache& cache : unit.caches)
        if (unit.rays > 0) counters.levels.push_back(cache.counters());
      result.units.push_back(counters);
      result.total += counters;
    }
    return result;
  }

 private:
  struct Unit {
    std::uint64_t rays = 0, tasks = 0;
    std::vector<SlowCache> caches;
  };
  struct Task {
    std::uint64_t code;
    int level;
    Vec3d parent_center;
  };

  /// A LIFO of tasks until the nearest voxel is met.
  void trace(Unit& unit, const CastRay& ray) {
    ++unit.rays;
    const double edge = static_cast<double>(1U << depth_);
    std::vector<Task> lifo{{1, 0, Vec3d(0)}};  // octant 7 of what is around the cube's corner
    while (!lifo.empty()) {
      const Task task = lifo.back();
      lifo.pop_back();
      ++unit.tasks;
      const double half = edge / static_cast<double>(2U << task.level);
      const std::uint64_t octant = task.level == 0 ? 7 : task.code % 8;
      const Vec3d center = task.parent_center + Vec3d(octant % 2 == 1 ? half : -half,
                                                      octant / 2 % 2 == 1 ? half : -half,
                                                      octant / 4 == 1 ? half : -half);
      if (!meets(ray, center - Vec3d(half), center + Vec3d(half))) continue;
      if (task.level == depth_) return;
      unit.caches[static_cast<std::size_t>(task.level)].read(task.code);
      push_children(lifo, task, center, ray.direction);
    }
  }

  void push_children(std::vector<Task>& lifo, const Task& task, const Vec3d& center,
                     const Vec3d& direction) const {
    const std::uint64_t mask =
        (direction.x < 0 ? 1 : 0) + (direction.y < 0 ? 2 : 0) + (direction.z < 0 ? 4 : 0);
    for (std::uint64_t i = 0; i < 8; ++i) {
      const std::uint64_t child = task.code * 8 + ((7 - i) ^ mask);
      if (nodes_.contains(child)) lifo.push_back({child, task.level + 1, center});
    }
  }

  /// The closed box by its slabs.
  static bool meets(const CastRay& ray, const Vec3d& lower, const Vec3d& upper) {
    double enter = 0, exit = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double o = ray.origin[axis], d = ray.direction[axis];
      if (d == 0 && (o < lower[axis] || o > upper[axis])) return false;
      if (d == 0) continue;
      const double a = (lower[axis] - o) / d, b = (upper[axis] - o) / d;
      enter = std::max(enter, std::min(a, b));
      exit = std::min(exit, std::max(a, b));
    }
    return enter <= exit;
  }

  int depth_;
  std::set<std::uint64_t> nodes_;
  std::vector<Unit> units_;
};

}  // namespace relumbre::experiment_testing
