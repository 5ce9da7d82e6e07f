#include "relumbre/octree/voxel_tree.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/voxel_tree_builder.h"

namespace relumbre {
namespace {

using test::blocks_of, test::random_voxels;

TEST(VoxelTree, HoldsTheVoxelsItWasBuiltFrom) {
  for (const unsigned depth : {0U, 1U, 2U, 3U, 4U, 5U, 8U, 11U, 16U}) {
    const auto codes = random_voxels(depth, 3000);
    const VoxelTree tree = build_tree({}, depth, Separating::k26, blocks_of(codes, true));
    check_tree(tree);
    ASSERT_EQ(tree.voxels(), codes.size()) << depth;
    std::size_t i = 0;
    for_each_voxel(tree, [&](std::uint64_t code, std::uint64_t index) {
      ASSERT_EQ(index, i);
      ASSERT_EQ(code, codes[i]);
      ASSERT_EQ(tree.values()[index], test::value_of(code));
      const auto child = tree.find(morton_decode(code));
      ASSERT_TRUE(child);
      ASSERT_EQ(&tree.value(*child), &tree.values()[index]);
      ++i;
    });
    EXPECT_EQ(i, codes.size());
  }
}

TEST(VoxelTree, FindsNothingWhereNothingIs) {
  const auto codes = random_voxels(4, 1000);
  const VoxelTree tree = build_tree({}, 4, Separating::k26, blocks_of(codes, true));
  for (std::uint64_t code = 0; code < 1 << 12; ++code)
    EXPECT_EQ(tree.find(morton_decode(code)).has_value(), std::ranges::binary_search(codes, code));
  for (std::uint64_t code = 0; code < 1 << 12; ++code) {
    const auto in_same_leaf = [&](std::uint64_t c) { return c >> 6 == code >> 6; };
    EXPECT_EQ(tree.find(morton_decode(code), 0).has_value(),
              std::ranges::any_of(codes, in_same_leaf));
  }
  EXPECT_FALSE(tree.find({16, 0, 0}));
  EXPECT_FALSE(tree.find({0, 0xFFFFFFFF, 0}));
}

TEST(VoxelTree, NodesHaveTheMeansOfTheirVoxels) {
  const auto codes = random_voxels(5, 2000);
  const VoxelTree tree = build_tree({}, 5, Separating::k26, blocks_of(codes, true));
  Rgb sum;
  for (const std::uint64_t code : codes) sum += unpack_color(test::value_of(code).color);
  const Rgb root = unpack_color(tree.node_values(0)[0].color);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(root[c], sum[c] / static_cast<float>(codes.size()), 2e-3F);
  std::vector<Rgb> leaf(tree.leaves().size());
  for (std::size_t l = 0, voxel = 0; l < leaf.size(); ++l) {
    const int count = std::popcount(tree.leaves()[l]);
    for (int i = 0; i < count; ++i, ++voxel)
      leaf[l] += unpack_color(tree.values()[voxel].color) / static_cast<float>(count);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(unpack_color(tree.node_values(2)[l].color)[c], leaf[l][c], 2e-3F);
  }
}

TEST(VoxelTree, NodesKeepApartTheSidesOfABoardOfTwoVoxels) {
  const std::uint32_t red = pack_color({1, 0, 0}), blue = pack_color({0, 0, 1});
  const std::uint32_t up = pack_normal({0, 0, 1}), down = pack_normal({0, 0, -1});
  const VoxelTree tree =
      build_tree({}, 2, Separating::k26,
                 {.code = {0},
                  .mask = {0b10001},
                  .value = {{red, VoxelValue::kNoBack, up}, {blue, VoxelValue::kNoBack, down}}});
  EXPECT_EQ(tree.node_values(0)[0], (VoxelValue{red, blue, up}));
}

TEST(VoxelTree, BlocksMustComeInOrderAndInTheGrid) {
  const auto codes = random_voxels(5, 500);
  VoxelBlocks blocks = blocks_of(codes, false);
  VoxelTreeBuilder builder({}, 5, Separating::k26);
  builder.add(blocks);
  EXPECT_THROW(builder.add(blocks), ValueError);
  VoxelTreeBuilder small({}, 3, Separating::k26);
  EXPECT_THROW(small.add({.code = {8}, .mask = {1}, .value = {}}), ValueError);
  EXPECT_THROW(small.add({.code = {0}, .mask = {0}, .value = {}}), ValueError);
  EXPECT_THROW(small.add({.code = {0}, .mask = {3}, .value = {{}}}), ValueError);
  EXPECT_THROW(small.finish(), ValueError);
  EXPECT_THROW(VoxelTreeBuilder({}, 17, Separating::k26), ValueError);
}

/// Copies of a tree's parts that can be spoilt.
struct Spoilt {
  std::vector<VoxelTree::Node> root, inner;
  std::vector<std::uint64_t> leaves;
  VoxelTree::Parts parts;
  explicit Spoilt(const VoxelTree& tree)
      : root(tree.nodes(0).begin(), tree.nodes(0).end()),
        inner(tree.nodes(1).begin(), tree.nodes(1).end()),
        leaves(tree.leaves().begin(), tree.leaves().end()),
        parts(tree.parts()) {
    parts.nodes[0] = root, parts.nodes[1] = inner, parts.leaves = leaves;
  }
};

TEST(VoxelTree, PartsThatDoNotBelongTogetherAreFound) {
  const VoxelTree tree =
      build_tree({}, 5, Separating::k26, blocks_of(random_voxels(5, 500), false));
  EXPECT_NO_THROW(check_tree(tree));
  const auto expect_found = [&](auto&& spoil) {
    Spoilt spoilt(tree);
    EXPECT_NO_THROW(check_tree(VoxelTree(spoilt.parts)));
    spoil(spoilt);
    EXPECT_THROW(check_tree(VoxelTree(spoilt.parts)), ShapeError);
  };
  expect_found([](Spoilt& s) { s.root[0].mask |= 0x100; });  // outside the grid of an odd depth
  expect_found([](Spoilt& s) { s.inner[1].first += 1; });
  expect_found([](Spoilt& s) { s.inner[0].mask = 0; });
  expect_found([](Spoilt& s) { s.inner.back().mask ^= 1; });
  expect_found([](Spoilt& s) { s.leaves[3] = 0; });
  expect_found([](Spoilt& s) { s.parts.leaves = s.parts.leaves.first(5); });
  expect_found([](Spoilt& s) { s.parts.nodes[0] = {}; });
  expect_found([](Spoilt& s) { s.parts.depth = 25; });
}

}  // namespace
}  // namespace relumbre
