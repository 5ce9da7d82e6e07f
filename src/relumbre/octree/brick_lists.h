/// Which triangles each brick of the grid has to look at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/octree/voxelize.h"

namespace relumbre {

/// A list a brick, in ascending order of the bricks' Morton codes; triangles in their order.
struct BrickLists {
  std::vector<std::uint32_t> brick;     ///< Morton code, of those with triangles
  std::vector<std::uint64_t> first;     ///< one a brick, and the end
  std::vector<std::uint32_t> triangle;  ///< all lists, one behind the other

  [[nodiscard]] std::size_t size() const { return brick.size(); }
  [[nodiscard]] std::span<const std::uint32_t> list(std::size_t i) const {
    return std::span(triangle).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// Bricks [first, last) by their Morton codes.
struct BrickRange {
  std::uint64_t first = 0, last = 0;
};

/// Cuts the cube into runs of bricks whose lists take about `list_bytes` each, or are those of a
/// single group of bricks, which is not cut further. Throws as voxelize(), and Cancelled.
std::vector<BrickRange> plan_passes(const TriangleMesh& mesh, const Cube& cube, unsigned depth,
                                    std::uint64_t list_bytes, Progress& progress);

BrickLists list_triangles(const TriangleMesh& mesh, const Cube& cube, unsigned depth,
                          const BrickRange& range, Progress& progress);

}  // namespace relumbre
