#include "relumbre/octree/octree.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan.h"

namespace relumbre {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 15;

/// Internal nodes of one level, in Morton order.
struct Level {
  HugeArray<std::uint64_t> codes;
  HugeArray<std::uint16_t> words;
};

void check_code(std::span<const std::uint64_t> voxels, std::size_t i, int depth) {
  const auto fail = [&](const char* reason) {
    throw ValueError("octree: voxel " + std::to_string(i) + " with code " +
                     std::to_string(voxels[i]) + " " + reason);
  };
  if (voxels[i] >> 3 * depth != 0) fail("lies outside the grid");
  if (i == 0) return;
  if (voxels[i] == voxels[i - 1]) fail("is there twice");
  if (voxels[i] < voxels[i - 1]) fail("comes after a larger one");
}

void check_voxels(std::span<const std::uint64_t> voxels, int depth) {
  if (depth < 1 || depth > kMaxDepth)
    throw ValueError("octree: depth " + std::to_string(depth) + " is not in 1 to " +
                     std::to_string(kMaxDepth));
  parallel_for(0, voxels.size(), kChunk, [&](std::size_t i) { check_code(voxels, i, depth); });
}

bool begins_parent(std::span<const std::uint64_t> codes, std::size_t i) {
  return i == 0 || codes[i] >> 3 != codes[i - 1] >> 3;
}

/// The number of parents that begin before each chunk of codes, and in all.
std::vector<std::size_t> count_parents(std::span<const std::uint64_t> codes) {
  std::vector<std::size_t> parents(codes.size() / kChunk + 2);
  parallel_chunks(0, codes.size(), kChunk, [&](std::size_t first, std::size_t last) {
    std::size_t count = 0;
    for (std::size_t i = first; i < last; ++i) count += begins_parent(codes, i) ? 1 : 0;
    parents[first / kChunk] = count;
  });
  exclusive_scan(parents, parents);
  return parents;
}

/// The level above `codes`. `state` is what a parent's bits say of each of them. A chunk writes the
/// parents that begin in it, and reads on to the end of the last.
Level parents_of(std::span<const std::uint64_t> codes, ChildState state) {
  const std::vector<std::size_t> before = count_parents(codes);
  Level level{HugeArray<std::uint64_t>(before.back()), HugeArray<std::uint16_t>(before.back())};
  parallel_chunks(0, codes.size(), kChunk, [&](std::size_t first, std::size_t last) {
    std::size_t node = before[first / kChunk], i = first;
    while (i < last && !begins_parent(codes, i)) ++i;
    for (; i < last; ++node) {
      const std::uint64_t parent = codes[i] >> 3;
      unsigned word = 0;
      for (; i < codes.size() && codes[i] >> 3 == parent; ++i)
        word |= static_cast<unsigned>(state) << 2 * octant_of(codes[i]);
      level.codes.data()[node] = parent;
      level.words.data()[node] = static_cast<std::uint16_t>(word);
    }
  });
  return level;
}

/// The words of levels depth-1 to 0, in this order.
std::vector<HugeArray<std::uint16_t>> build_words(std::span<const std::uint64_t> voxels,
                                                  int depth) {
  std::vector<HugeArray<std::uint16_t>> levels;
  Level level = parents_of(voxels, ChildState::kVoxel);
  for (int above = depth - 1; above > 0; --above) {
    Level parents = parents_of(level.codes.span(), ChildState::kNonEmpty);
    levels.push_back(std::move(level.words));
    level = std::move(parents);
  }
  levels.push_back(std::move(level.words));
  return levels;
}

}  // namespace

Octree::Octree(std::span<const std::uint64_t> voxels, int depth) : depth_(depth) {
  check_voxels(voxels, depth);
  const std::vector<HugeArray<std::uint16_t>> levels = build_words(voxels, depth);
  nodes_[static_cast<std::size_t>(depth)] = voxels.size();
  for (std::size_t i = 0; i < levels.size(); ++i) nodes_[levels.size() - 1 - i] = levels[i].size();
  nodes_[0] = 1;  // also of no voxels

  const std::size_t all = std::accumulate(nodes_.begin(), nodes_.begin() + depth, std::size_t{0});
  if (all >= kNone)
    throw ValueError("octree: " + std::to_string(all) + " internal nodes are more than " +
                     std::to_string(kNone - 1));
  words_ = HugeArray<std::uint16_t>(all);
  words_.data()[0] = 0;
  std::uint16_t* end = words_.data();
  for (std::size_t i = levels.size(); i-- > 0;)
    end = std::copy_n(levels[i].data(), levels[i].size(), end);
  link_children();
  fill_table();
}

void Octree::link_children() {
  firsts_ = HugeArray<Index>(words_.size() - nodes(depth_ - 1));
  const std::span<Index> firsts = firsts_.span();
  parallel_for(0, firsts.size(), kChunk,
               [&](std::size_t i) { firsts[i] = word(static_cast<Index>(i)).non_empty(); });
  exclusive_scan(firsts, firsts);
  // The root comes before every child.
  parallel_for(0, firsts.size(), kChunk, [&](std::size_t i) { ++firsts[i]; });
}

void Octree::fill_table() {
  while (table_level_ < depth_ - 1 && (std::size_t{2} << 3 * (table_level_ + 1)) <= words_.size())
    ++table_level_;
  table_ = HugeArray<Index>(std::size_t{2} << 3 * table_level_);
  const std::span<Index> table = table_.span();
  std::fill(table.begin(), table.end(), kNone);
  table[kRootCode] = 0;
  for (int level = 0; level < table_level_; ++level) {
    const CodeRange codes = descendants_of(kRootCode, level);
    parallel_for(codes.first, codes.last + 1, kChunk / 8, [&](std::size_t code) {
      const Index node = table[code];
      if (node == kNone) return;
      for (unsigned octant = 0; octant < 8; ++octant)
        if (word(node).child(octant) == ChildState::kNonEmpty)
          table[child_of(code, octant)] = child(node, word(node), octant);
    });
  }
}

std::size_t Octree::nodes(int level) const {
  if (level < 0 || level > depth_)
    throw ValueError("octree: level " + std::to_string(level) + " is not in 0 to " +
                     std::to_string(depth_));
  return nodes_[static_cast<std::size_t>(level)];
}

std::size_t Octree::bytes() const {
  return sizeof(*this) + words_.span().size_bytes() + firsts_.span().size_bytes() +
         table_.span().size_bytes();
}

Octree::Index Octree::find(LocationCode code) const {
  if (!is_location_code(code) || level_of(code) >= depth_) return kNone;
  const int level = level_of(code);
  int reached = std::min(level, table_level_);
  Index node = table_.data()[ancestor_of(code, reached)];
  while (node != kNone && reached < level) {
    const unsigned octant = octant_of(ancestor_of(code, ++reached));
    const NodeWord bits = word(node);
    node = bits.child(octant) == ChildState::kNonEmpty ? child(node, bits, octant) : kNone;
  }
  return node;
}

}  // namespace relumbre
