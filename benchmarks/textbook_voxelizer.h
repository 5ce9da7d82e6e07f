/// The voxeliser that one would write first, on one thread: a peer for the library's.
#pragma once

#include <cstdint>
#include <vector>

#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/octree/cube.h"

namespace relumbre::bench {

/// Sorted Morton codes of the voxels that triangles touch: each triangle against all voxels of its
/// bounding box by Akenine-Möller's separating axes (2001), in float64, then a sort.
std::vector<std::uint64_t> textbook_voxels(const TriangleMesh& mesh, const Cube& cube,
                                           unsigned depth);

}  // namespace relumbre::bench
