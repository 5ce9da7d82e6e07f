/// Voxel sets for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "relumbre/octree/morton.h"
#include "relumbre/octree/voxel_blocks.h"

namespace relumbre::test {

/// Sorted Morton codes.
using VoxelSet = std::vector<std::uint64_t>;

/// About `count` of a grid of 2^depth cells per edge, the first and the last among them.
inline VoxelSet random_voxels(int depth, std::size_t count, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  const std::uint64_t last = (std::uint64_t{1} << 3 * depth) - 1;
  VoxelSet voxels{0, last};
  for (std::size_t i = 0; i < count; ++i) voxels.push_back(random() & last);
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

inline VoxelSet all_voxels(int depth) {
  VoxelSet voxels(std::size_t{1} << 3 * depth);
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = i;
  return voxels;
}

/// Cells that the sphere about the cube's centre, of 0.45 of its edge, passes through: those with
/// corners within and outside.
inline VoxelSet shell(int depth) {
  const auto edge = static_cast<std::int64_t>(1) << depth;
  const double radius2 = 0.81 * static_cast<double>(edge * edge);
  VoxelSet voxels;
  // In halves of a cell about the centre: a cell reaches from 2·i - edge to 2·i - edge + 2.
  const auto nearer = [&](std::int64_t i) {
    return std::min(std::abs(2 * i - edge), std::abs(2 * i + 2 - edge));
  };
  const auto farther = [&](std::int64_t i) {
    return std::max(std::abs(2 * i - edge), std::abs(2 * i + 2 - edge));
  };
  for (std::int64_t z = 0; z < edge; ++z)
    for (std::int64_t y = 0; y < edge; ++y)
      for (std::int64_t x = 0; x < edge; ++x) {
        const std::int64_t a = nearer(x), b = nearer(y), c = nearer(z);
        const std::int64_t p = farther(x), q = farther(y), r = farther(z);
        if (static_cast<double>(a * a + b * b + c * c) <= radius2 &&
            radius2 < static_cast<double>(p * p + q * q + r * r))
          voxels.push_back(
              morton_encode(Cell{static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                 static_cast<std::uint32_t>(z)}));
      }
  std::sort(voxels.begin(), voxels.end());
  return voxels;
}

/// A value of its own for each code.
inline VoxelValue value_of(std::uint64_t code) {
  const auto c = static_cast<float>(code % 97) / 97;
  return {pack_color({c, 1 - c, 0.5F}), pack_color({1 - c, 0.25F, c}), pack_normal({c, 0.3F, 1})};
}

inline VoxelBlocks blocks_of(const VoxelSet& codes, bool with_values) {
  VoxelBlocks blocks;
  for (const std::uint64_t code : codes) {
    if (blocks.code.empty() || blocks.code.back() != code >> 6) {
      blocks.code.push_back(code >> 6);
      blocks.mask.push_back(0);
    }
    blocks.mask.back() |= std::uint64_t{1} << (code & 63);
    if (with_values) blocks.value.push_back(value_of(code));
  }
  return blocks;
}

}  // namespace relumbre::test
