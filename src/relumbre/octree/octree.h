/// The sparse voxel octree that traversals are counted on: one word per internal node, no pointers.
///
///   word     bits 15 14   13 12   ...   3 2   1 0        0 empty      1 voxel
///            child  7       6     ...    1     0         2 non-empty  3 reserved
///
/// Internal nodes have levels 0 to depth-1; voxels have no word, their parent's bits say it. Words
/// are asked for by location code. They are stored breadth first, in Morton order within a level,
/// so that the non-empty children of a node follow each other, and need no codes:
///
///   words    w0 | w1 w2 ... | ...   level by level                            2 bytes per node
///   firsts   the index of the first non-empty child, by an exclusive scan of the numbers of
///            such children; not of the last level, so for about a quarter     4 bytes each
///   table    by location code, the index of every node down to level T, the
///            deepest with 2·8^T no more than there are nodes                  4 at most per node
///
/// A descent takes one step a level, child(). find() of a code starts from its ancestor in the
/// table: a surface has about 4^depth nodes, so that T is near 2/3 of the depth and at most 4 steps
/// remain at depth 12. A hash table would take one probe, but has to store the codes, 8 bytes each.
///
/// Immutable after construction: any number of threads may read it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "relumbre/base/huge_array.h"
#include "relumbre/octree/location_code.h"

namespace relumbre {

enum class ChildState : std::uint8_t { kEmpty = 0, kVoxel = 1, kNonEmpty = 2 };

/// Of the children of an internal node.
struct NodeWord {
  std::uint16_t bits;

  [[nodiscard]] ChildState child(unsigned octant) const {
    return static_cast<ChildState>(bits >> (2 * octant) & 3U);
  }
  /// How many children are non-empty (voxels are not counted).
  [[nodiscard]] unsigned non_empty() const { return count(bits); }
  /// The same, of those before `octant`.
  [[nodiscard]] unsigned non_empty_before(unsigned octant) const {
    return count(bits & ((1U << 2 * octant) - 1));
  }

 private:
  /// Set bits at odd places: sums of pairs, then of all four pairs at once.
  static unsigned count(unsigned bits) {
    const unsigned ones = bits >> 1 & 0x5555U;
    const unsigned sums = (ones & 0x3333U) + (ones >> 2 & 0x3333U);
    return (sums * 0x1111U) >> 12 & 0xFU;
  }
};

class Octree {
 public:
  /// Of an internal node, in the order of storage. The root has 0.
  using Index = std::uint32_t;
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  /// `voxels`: Morton codes, strictly increasing, below 8^depth; none make a tree whose root is
  /// empty. Threaded. Reads the codes three times, and needs for a while some 13 bytes per
  /// parent of voxels beside the tree. Throws ValueError for a depth outside 1 to kMaxDepth, for
  /// codes that are out of order, repeated or out of range, and for more than 2^32 - 2 internal
  /// nodes.
  Octree(std::span<const std::uint64_t> voxels, int depth);

  [[nodiscard]] int depth() const { return depth_; }
  /// At a level 0 to depth: internal nodes, at the last voxels.
  [[nodiscard]] std::size_t nodes(int level) const;
  [[nodiscard]] std::size_t voxels() const { return nodes(depth_); }
  [[nodiscard]] std::size_t internal_nodes() const { return words_.size(); }
  /// Memory held.
  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] NodeWord word(Index node) const { return {words_.data()[node]}; }

  /// The child of a node above the last level whose word, which is passed along, says non-empty.
  [[nodiscard]] Index child(Index node, NodeWord word, unsigned octant) const {
    return firsts_.data()[node] + word.non_empty_before(octant);
  }

  /// The internal node of any 64-bit code, or kNone.
  [[nodiscard]] Index find(LocationCode code) const;

 private:
  void link_children();
  void fill_table();

  int depth_ = 0, table_level_ = 0;
  std::array<std::size_t, kMaxDepth + 1> nodes_{};
  HugeArray<std::uint16_t> words_;
  HugeArray<Index> firsts_, table_;
};

}  // namespace relumbre
