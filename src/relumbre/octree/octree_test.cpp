#include "relumbre/octree/octree.h"

#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/test_voxels.h"

namespace relumbre {
namespace {

using test::all_voxels, test::random_voxels, test::shell, test::VoxelSet;

using Words = std::map<LocationCode, unsigned>;

/// Marks every voxel's ancestors, one voxel at a time.
Words slow_words(const VoxelSet& voxels, int depth) {
  Words words{{kRootCode, 0}};
  for (const std::uint64_t voxel : voxels) {
    unsigned state = 1;
    for (LocationCode code = location_code(depth, voxel); code != kRootCode;
         code = parent_of(code)) {
      words[parent_of(code)] |= state << 2 * octant_of(code);
      state = 2;
    }
  }
  return words;
}

void expect_words(const Octree& octree, const Words& words) {
  ASSERT_EQ(octree.internal_nodes(), words.size());
  Octree::Index next = 0;
  std::vector<std::size_t> nodes(static_cast<std::size_t>(octree.depth()));
  for (const auto& [code, word] : words) {  // by level, in Morton order
    ASSERT_EQ(octree.find(code), next++) << code;
    ASSERT_EQ(octree.word(octree.find(code)).bits, word) << code;
    ++nodes[static_cast<std::size_t>(level_of(code))];
  }
  for (int level = 0; level < octree.depth(); ++level)
    EXPECT_EQ(octree.nodes(level), nodes[static_cast<std::size_t>(level)]);
}

void expect_children(const Octree& octree, const Words& words) {
  for (const auto& [code, bits] : words) {
    const Octree::Index node = octree.find(code);
    for (unsigned octant = 0; octant < 8; ++octant) {
      const auto state = static_cast<ChildState>(bits >> 2 * octant & 3);
      ASSERT_EQ(octree.word(node).child(octant), state);
      const Octree::Index found = octree.find(child_of(code, octant));
      if (state == ChildState::kNonEmpty)
        ASSERT_EQ(octree.child(node, octree.word(node), octant), found);
      else
        ASSERT_EQ(found, Octree::kNone);
    }
  }
}

void expect_tree_of(const VoxelSet& voxels, int depth) {
  SCOPED_TRACE(testing::Message() << voxels.size() << " voxels, depth " << depth);
  const Words words = slow_words(voxels, depth);
  const Octree octree(voxels, depth);
  EXPECT_EQ(octree.depth(), depth);
  EXPECT_EQ(octree.voxels(), voxels.size());
  expect_words(octree, words);
  expect_children(octree, words);
}

TEST(Octree, WordsEqualTheMarksOfEveryVoxel) {
  for (int depth = 1; depth <= 8; ++depth)
    for (const std::size_t count : {1U, 2U, 10U, 1000U, 30'000U})
      expect_tree_of(random_voxels(depth, count, static_cast<std::uint64_t>(depth)), depth);
  for (int depth = 1; depth <= 7; ++depth) expect_tree_of(shell(depth), depth);
  for (int depth = 1; depth <= 5; ++depth) expect_tree_of(all_voxels(depth), depth);
}

TEST(Octree, WordsEqualTheMarksAtTheGreatestDepth) {
  expect_tree_of(random_voxels(kMaxDepth, 3000, 1), kMaxDepth);
  expect_tree_of({0, (std::uint64_t{1} << 3 * kMaxDepth) - 1}, kMaxDepth);
}

TEST(Octree, AFullGridHasAllNodes) {
  const Octree octree(all_voxels(6), 6);
  for (int level = 0; level <= 6; ++level) EXPECT_EQ(octree.nodes(level), 1ULL << 3 * level);
  EXPECT_EQ(octree.word(0).bits, 0xAAAA);
  EXPECT_EQ(octree.word(octree.find(location_code(5, 77))).bits, 0x5555);
}

TEST(Octree, OfNothingHasAnEmptyRoot) {
  for (const int depth : {1, 2, kMaxDepth}) {
    expect_tree_of({}, depth);
    const Octree octree({}, depth);
    EXPECT_EQ(octree.nodes(0), 1U);
    EXPECT_EQ(octree.voxels(), 0U);
  }
}

TEST(Octree, TheNumberOfThreadsChangesNothing) {
  const VoxelSet voxels = random_voxels(7, 300'000, 4);  // several chunks at several levels
  const Words words = slow_words(voxels, 7);
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const ThreadLimit limit(threads);
    expect_words(Octree(voxels, 7), words);
  }
}

TEST(Octree, ChunksMayEndWithinANode) {
  // 7 of 8 siblings: nodes straddle the ends of chunks at every level, in every way.
  VoxelSet voxels = all_voxels(6);
  std::erase_if(voxels, [](std::uint64_t code) { return code % 8 == code / 8 % 8; });
  expect_tree_of(voxels, 6);
}

TEST(Octree, FindsNothingForWhatIsNoInternalNode) {
  const Octree octree(shell(4), 4);
  EXPECT_EQ(octree.find(location_code(4, shell(4).front())), Octree::kNone) << "a voxel";
  std::mt19937_64 random(1);
  const Words words = slow_words(shell(4), 4);
  for (std::uint64_t code = 0; code < 1 << 16; ++code)
    ASSERT_EQ(octree.find(code) == Octree::kNone, !words.contains(code)) << code;
  for (int i = 0; i < 10'000; ++i) ASSERT_EQ(octree.find(random() | 1ULL << 20), Octree::kNone);
}

TEST(Octree, CountsNonEmptyChildrenAsOneByOne) {
  for (unsigned bits = 0; bits <= 0xFFFF; ++bits) {
    const NodeWord word{static_cast<std::uint16_t>(bits)};
    unsigned count = 0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      ASSERT_EQ(word.non_empty_before(octant), count);
      // The reserved value is in no tree; its upper bit counts.
      count += bits >> (2 * octant + 1) & 1;
    }
    ASSERT_EQ(word.non_empty(), count);
  }
}

TEST(Octree, MemoryIsProportionalToNodes) {
  for (int depth = 1; depth <= 8; ++depth) {
    const Octree octree(shell(depth), depth);
    EXPECT_LE(octree.bytes(), sizeof(Octree) + 8 + 10 * octree.internal_nodes());
  }
}

std::string refusal(const VoxelSet& voxels, int depth) {
  try {
    Octree octree(voxels, depth);
  } catch (const ValueError& e) {
    return e.what();
  }
  return "none";
}

TEST(Octree, BadInputIsRefused) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal({1}, 0), HasSubstr("depth 0"));
  EXPECT_THAT(refusal({1}, -3), HasSubstr("depth -3"));
  EXPECT_THAT(refusal({1}, kMaxDepth + 1), HasSubstr("depth 21"));
  EXPECT_THAT(refusal({8}, 1), HasSubstr("voxel 0 with code 8 lies outside the grid"));
  EXPECT_THAT(refusal({0, ~std::uint64_t{0}}, kMaxDepth), HasSubstr("outside"));
  EXPECT_THAT(refusal({1, 3, 2}, 1), HasSubstr("voxel 2 with code 2 comes after a larger one"));
  EXPECT_THAT(refusal({1, 3, 3}, 1), HasSubstr("voxel 2 with code 3 is there twice"));
  VoxelSet late = all_voxels(6);
  std::swap(late[200'000], late[200'001]);
  EXPECT_THAT(refusal(late, 6), HasSubstr("voxel 200001"));
}

TEST(Octree, LevelsOutsideAreRefused) {
  const Octree octree(shell(3), 3);
  EXPECT_THROW((void)octree.nodes(-1), ValueError);
  EXPECT_THROW((void)octree.nodes(4), ValueError);
}

}  // namespace
}  // namespace relumbre
