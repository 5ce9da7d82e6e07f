#include "relumbre/octree/voxel_tree.h"

#include <algorithm>
#include <string>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

std::uint64_t count_bits(std::span<const std::uint64_t> masks) {
  std::uint64_t sum = 0;
  for (const std::uint64_t mask : masks) sum += static_cast<std::uint64_t>(std::popcount(mask));
  return sum;
}

void require(bool holds, const std::string& what) {
  if (!holds) throw ShapeError("octree: " + what);
}

/// The root's children, or the only leaf's voxels, that lie in the grid.
std::uint64_t mask_in_grid(unsigned depth) {
  if (depth == 0) return 1;
  return depth % 2 == 1 ? 0xFF : ~std::uint64_t{0};
}

void check_nodes(std::span<const VoxelTree::Node> nodes, std::size_t children, unsigned level) {
  const std::string where = "level " + std::to_string(level);
  std::uint64_t first = 0;
  for (const VoxelTree::Node& node : nodes) {
    require(node.mask != 0, where + " has an empty node");
    require(node.first == first,
            where + " has a node whose children are not behind the last one's");
    first += static_cast<std::uint64_t>(std::popcount(node.mask));
  }
  require(first == children, where + " has " + std::to_string(first) +
                                 " children, the next level " + std::to_string(children) +
                                 " nodes");
}

void check_values(const VoxelTree& tree) {
  const VoxelTree::Parts& parts = tree.parts();
  require(parts.first_voxel.size() == parts.leaves.size(), "a leaf has no first voxel");
  std::uint64_t first = 0;
  for (std::size_t i = 0; i < parts.leaves.size(); ++i) {
    require(parts.first_voxel[i] == first,
            "leaf " + std::to_string(i) + " has a wrong first voxel");
    first += static_cast<std::uint64_t>(std::popcount(parts.leaves[i]));
  }
  require(first == parts.values.size(),
          std::to_string(parts.values.size()) + " values for " + std::to_string(first) + " voxels");
  for (unsigned level = 0; level < tree.levels(); ++level) {
    require(parts.node_values[level].size() == tree.size(level),
            "level " + std::to_string(level) + " has a wrong number of values");
  }
}

}  // namespace

std::uint64_t VoxelTree::voxels() const {
  return has_values() ? parts_.values.size() : count_bits(parts_.leaves);
}

std::uint64_t VoxelTree::geometry_bytes() const {
  std::uint64_t bytes = parts_.leaves.size_bytes();
  for (const auto& nodes : parts_.nodes) bytes += nodes.size_bytes();
  return bytes;
}

std::optional<VoxelTree::Child> VoxelTree::find(const Cell& cell, unsigned level) const {
  if (std::max({cell.x, cell.y, cell.z}) >> depth() != 0) return std::nullopt;
  const std::uint64_t code = morton_encode(cell);
  std::uint64_t node = 0;
  for (unsigned at = 0;; ++at) {
    const auto bit = static_cast<unsigned>(code >> 6 * (levels() - 1 - at) & 63);
    const bool is_leaf = at + 1 == levels();
    const std::uint64_t mask = is_leaf ? leaves()[node] : nodes(at)[node].mask;
    if (!(mask >> bit & 1)) return std::nullopt;
    if (at == level) return Child{node, bit, level};
    node = nodes(at)[node].first + rank(mask, bit);
  }
}

const VoxelValue& VoxelTree::value(const Child& child) const {
  if (child.level + 1 == levels()) {
    return values()[parts_.first_voxel[child.parent] + rank(leaves()[child.parent], child.bit)];
  }
  const Node& parent = nodes(child.level)[child.parent];
  return node_values(child.level + 1)[parent.first + rank(parent.mask, child.bit)];
}

std::vector<std::uint64_t> voxel_codes(const VoxelTree& tree) {
  std::vector<std::uint64_t> codes;
  codes.reserve(tree.voxels());
  for_each_voxel(tree, [&](std::uint64_t code, std::uint64_t) { codes.push_back(code); });
  return codes;
}

void check_tree(const VoxelTree& tree) {
  const VoxelTree::Parts& parts = tree.parts();
  const unsigned levels = tree.levels();
  require(levels <= VoxelTree::kMaxLevels,
          "depth " + std::to_string(parts.depth) + " is too large");
  require(levels == 1 ? parts.leaves.size() == 1 : parts.nodes[0].size() == 1, "there is no root");
  const std::uint64_t root = levels == 1 ? parts.leaves[0] : parts.nodes[0][0].mask;
  require((root & ~mask_in_grid(parts.depth)) == 0, "there are voxels outside the grid");
  for (unsigned level = 0; level + 1 < levels; ++level) {
    check_nodes(parts.nodes[level], tree.size(level + 1), level);
  }
  require(std::ranges::find(parts.leaves, std::uint64_t{0}) == parts.leaves.end(),
          "there is an empty leaf");
  if (tree.has_values()) check_values(tree);
}

}  // namespace relumbre
