/// Many rays through a VoxelTree on one thread, compiled once per instruction set.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "relumbre/octree/tree_cast.h"

namespace relumbre {

/// One instruction set's.
struct CastKernel {
  std::string_view name;
  /// As cast() of a batch; the sizes are the same, and the tree is not without nodes.
  void (*cast)(const VoxelTree& tree, std::span<const CastRay> rays, std::span<TreeHit> hits);
};

/// For the best instruction set that this CPU has.
const CastKernel& best_cast_kernel();

/// All that this CPU can run, best first, for tests. Not thread-safe.
std::vector<CastKernel> available_cast_kernels();

}  // namespace relumbre
