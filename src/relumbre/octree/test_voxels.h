/// Voxels made for tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "relumbre/base/sampling.h"
#include "relumbre/octree/voxel_blocks.h"

namespace relumbre::test {

/// Sorted, unique Morton codes in a grid of this depth, the first and the last among them.
inline std::vector<std::uint64_t> random_codes(unsigned depth, std::size_t count) {
  const std::uint64_t end = std::uint64_t{1} << 3 * depth;
  RandomStream random(depth);
  std::vector<std::uint64_t> codes{0, end - 1};
  for (std::size_t i = 0; i < count; ++i)
    codes.push_back(static_cast<std::uint64_t>(random.uniform() * static_cast<float>(end)) % end);
  std::ranges::sort(codes);
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

/// A value of its own for each code.
inline VoxelValue value_of(std::uint64_t code) {
  const auto c = static_cast<float>(code % 97) / 97;
  return {pack_color({c, 1 - c, 0.5F}), pack_color({1 - c, 0.25F, c}), pack_normal({c, 0.3F, 1})};
}

inline VoxelBlocks blocks_of(const std::vector<std::uint64_t>& codes, bool with_values) {
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
