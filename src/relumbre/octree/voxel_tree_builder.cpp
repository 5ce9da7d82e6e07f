#include "relumbre/octree/voxel_tree_builder.h"

#include <bit>
#include <memory>
#include <string>
#include <utility>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan.h"

namespace relumbre {

namespace {

/// What the finished tree's spans point into.
struct Storage {
  std::array<std::vector<VoxelTree::Node>, VoxelTree::kMaxLevels> nodes;
  std::array<std::vector<VoxelValue>, VoxelTree::kMaxLevels> node_values;
  std::vector<std::uint64_t> leaves, first_voxel;
  std::vector<VoxelValue> values;
};

/// Where each mask's bits begin among all: the scan of their counts.
template <class MaskOf>
std::vector<std::uint64_t> first_children(std::size_t size, const MaskOf& mask) {
  std::vector<std::uint64_t> first(size);
  parallel_for(0, size, 4096, [&](std::size_t i) {
    first[i] = static_cast<std::uint64_t>(std::popcount(mask(i)));
  });
  exclusive_scan(first, first);
  return first;
}

}  // namespace

VoxelTreeBuilder::VoxelTreeBuilder(const Cube& cube, unsigned depth, Separating separating,
                                   ValueSink values)
    : cube_(cube),
      depth_(depth),
      separating_(separating),
      sink_(std::move(values)),
      inner_(VoxelTree::levels_of(depth) - 1) {
  if (VoxelTree::levels_of(depth) > VoxelTree::kMaxLevels)
    throw ValueError("depth " + std::to_string(depth) + " is too large for an octree");
}

void VoxelTreeBuilder::add(const VoxelBlocks& blocks) {
  if (leaves_.empty()) has_values_ = !blocks.value.empty();
  if (blocks.value.size() != (has_values_ ? blocks.voxels() : 0))
    throw ValueError("some voxels have values and others do not");
  const VoxelValue* value = blocks.value.data();
  for (std::size_t i = 0; i < blocks.code.size(); ++i) {
    VoxelMean mean;
    for (int left = has_values_ ? std::popcount(blocks.mask[i]) : 0; left > 0; --left, ++value)
      mean.add(*value);
    add_leaf(blocks.code[i], blocks.mask[i], mean);
  }
  if (sink_)
    sink_(blocks.value);
  else
    values_.insert(values_.end(), blocks.value.begin(), blocks.value.end());
}

void VoxelTreeBuilder::add_leaf(std::uint64_t code, std::uint64_t mask, const VoxelMean& mean) {
  const unsigned levels = depth_ > VoxelBlocks::kDepth ? depth_ - VoxelBlocks::kDepth : 0;
  const std::uint64_t end = std::uint64_t{1} << 3 * levels;
  if (mask == 0 || code < next_code_ || code >= end)
    throw ValueError("block " + std::to_string(code) +
                     " of voxels is empty, out of order or outside the grid");
  next_code_ = code + 1;
  leaves_.push_back(mask);
  if (has_values_) leaf_values_.push_back(mean.value());
  if (!inner_.empty()) add_child(inner_.size() - 1, code, mean);
}

/// Opens the child's parent, if it is another than the last one, and adds the child to it.
void VoxelTreeBuilder::add_child(std::size_t level, std::uint64_t code, const VoxelMean& mean) {
  Level& at = inner_[level];
  if (at.mask != 0 && at.code != code >> 6) close(level);
  at.code = code >> 6;
  at.mask |= std::uint64_t{1} << (code & 63);
  at.mean.add(mean);
}

/// The node is complete, and so a child of the level above.
void VoxelTreeBuilder::close(std::size_t level) {
  Level& at = inner_[level];
  at.nodes.push_back({at.mask, 0});
  if (has_values_) at.values.push_back(at.mean.value());
  if (level > 0) add_child(level - 1, at.code, at.mean);
  at.mask = 0;
  at.mean = {};
}

VoxelTree VoxelTreeBuilder::finish() {
  if (leaves_.empty()) throw ValueError("there are no voxels to build an octree from");
  for (std::size_t level = inner_.size(); level-- > 0;) close(level);
  auto storage = std::make_shared<Storage>();
  VoxelTree::Parts parts{.cube = cube_, .depth = depth_, .separating = separating_};
  for (std::size_t level = 0; level < inner_.size(); ++level) {
    std::vector<VoxelTree::Node>& nodes = storage->nodes[level] = std::move(inner_[level].nodes);
    const auto first = first_children(nodes.size(), [&](std::size_t i) { return nodes[i].mask; });
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].first = first[i];
    parts.nodes[level] = nodes;
    parts.node_values[level] = storage->node_values[level] = std::move(inner_[level].values);
  }
  parts.leaves = storage->leaves = std::move(leaves_);
  if (has_values_) {
    storage->first_voxel =
        first_children(parts.leaves.size(), [&](std::size_t i) { return parts.leaves[i]; });
    parts.first_voxel = storage->first_voxel;
    parts.values = storage->values = std::move(values_);
    parts.node_values[inner_.size()] = storage->node_values[inner_.size()] =
        std::move(leaf_values_);
  }
  parts.owner = std::move(storage);
  return VoxelTree(std::move(parts));
}

VoxelTree build_tree(const Cube& cube, unsigned depth, Separating separating,
                     const VoxelBlocks& blocks) {
  VoxelTreeBuilder builder(cube, depth, separating);
  builder.add(blocks);
  return builder.finish();
}

}  // namespace relumbre
