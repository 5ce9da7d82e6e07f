/// Traces made for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/archsim/trace_recorder.h"
#include "relumbre/base/sampling.h"

namespace relumbre::archsim_testing {

/// One ray's reads: level and address.
struct Read {
  int level;
  std::uint64_t address;
  friend bool operator==(const Read&, const Read&) = default;
};
struct RayReads {
  std::uint32_t tasks = 0;
  std::vector<Read> reads;
};

/// Walks down a tree and now and then a few levels up again, as a traversal does. Neighbouring
/// seeds often take the same turns, as neighbouring rays do. One ray in eight misses the root.
inline RayReads random_ray(std::uint64_t seed, int levels) {
  RandomStream random(seed), shared(seed / 16);
  RayReads ray{.tasks = 1, .reads = {}};
  if (random.bits() % 8 == 0) return ray;
  std::vector<std::uint64_t> path{1};
  ray.reads.push_back({0, 1});
  const std::size_t steps = random.bits() % 40;
  for (std::size_t i = 0; i < steps; ++i) {
    ray.tasks += static_cast<std::uint32_t>(1 + random.bits() % 8);
    const std::uint64_t turn = shared.bits(), own = random.bits();
    const bool is_deep = path.size() == static_cast<std::size_t>(levels);
    for (std::size_t up = is_deep ? 1 + turn % 3 : 0; up > 0 && path.size() > 1; --up)
      path.pop_back();
    if (path.size() == static_cast<std::size_t>(levels)) break;  // there is but one level
    path.push_back(path.back() * 8 + (own % 8 == 0 ? own / 8 % 8 : turn / 8 % 8));
    ray.reads.push_back({static_cast<int>(path.size()) - 1, path.back()});
  }
  return ray;
}

inline Trace record(const TraceShape& shape, const std::vector<RayReads>& rays) {
  TraceRecorder recorder(shape);
  for (std::uint32_t y = 0; y < shape.height; ++y) {
    TraceRecorder::Row row = recorder.row(y);
    for (std::uint32_t x = 0; x < shape.width; ++x) {
      const RayReads& ray = rays[std::size_t{y} * shape.width + x];
      row.begin_ray();
      for (std::uint32_t i = 0; i < ray.tasks; ++i) row.task();
      for (const Read& read : ray.reads) row.read(read.address, read.level);
    }
    row.finish();
  }
  return recorder.finish();
}

inline std::vector<RayReads> random_rays(const TraceShape& shape, std::uint64_t seed) {
  std::vector<RayReads> rays;
  for (std::size_t i = 0; i < shape.pixels(); ++i)
    rays.push_back(random_ray(seed * 1'000'000 + i, shape.levels));
  return rays;
}

inline Trace random_trace(const TraceShape& shape, std::uint64_t seed) {
  return record(shape, random_rays(shape, seed));
}

}  // namespace relumbre::archsim_testing
