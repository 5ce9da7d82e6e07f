/// NanoVDB's marcher over the same voxels, for benchmarks.
#pragma once

#include <memory>
#include <span>

#include "relumbre/octree/tree_cast.h"

namespace relumbre::bench {

/// A grid with values of 4 bits, its most compact kind that it can build itself.
class NanoVdbPeer {
 public:
  explicit NanoVdbPeer(const VoxelTree& tree);
  ~NanoVdbPeer();

  /// Whether this program was built with NanoVDB; without it nothing else may be called.
  static bool is_there();
  /// nanovdb::firstActive() of each ray: the hits' cells, or kMiss. One thread.
  void cast(std::span<const CastRay> rays, std::span<Cell> cells) const;
  static constexpr Cell kMiss{~0U, ~0U, ~0U};

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace relumbre::bench
