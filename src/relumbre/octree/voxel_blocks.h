/// Voxels in blocks of 4 × 4 × 4: what the voxeliser makes and the octrees are built from.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "relumbre/octree/voxel_value.h"

namespace relumbre {

/// Blocks in ascending order of their Morton codes, none empty. A grid of depth 0 or 1 is the lower
/// corner of one block.
///
///   Morton code of a voxel   ... z3 y3 x3 z2 y2 x2 | z1 y1 x1 z0 y0 x0
///                                       block code | bit of its mask
struct VoxelBlocks {
  static constexpr unsigned kDepth = 2;  ///< levels in a block
  std::vector<std::uint64_t> code;
  std::vector<std::uint64_t> mask;
  std::vector<VoxelValue> value;  ///< none, or one a voxel, in the order of their Morton codes

  [[nodiscard]] std::size_t voxels() const {
    return std::accumulate(mask.begin(), mask.end(), std::size_t{0},
                           [](std::size_t sum, std::uint64_t m) {
                             return sum + static_cast<std::size_t>(std::popcount(m));
                           });
  }
};

/// The voxels' Morton codes, ascending: what an Octree is built from.
inline std::vector<std::uint64_t> voxel_codes(const VoxelBlocks& blocks) {
  std::vector<std::uint64_t> codes;
  codes.reserve(blocks.voxels());
  for (std::size_t b = 0; b < blocks.code.size(); ++b)
    for (std::uint64_t mask = blocks.mask[b]; mask != 0; mask &= mask - 1)
      codes.push_back(blocks.code[b] << 6 | static_cast<unsigned>(std::countr_zero(mask)));
  return codes;
}

}  // namespace relumbre
