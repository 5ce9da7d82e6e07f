#include "relumbre/octree/rlo_file.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/octree/test_voxels.h"
#include "relumbre/octree/voxel_tree_builder.h"

namespace relumbre {
namespace {

using test::blocks_of, test::random_voxels;

class Rlo : public testing::Test {
 protected:
  void write(unsigned depth, const VoxelBlocks& blocks) const {
    RloWriter writer(file_, cube_, depth, Separating::k6, VoxelTree::Content::kRadiosity);
    writer.add(blocks);
    writer.finish(1.5);
  }
  void expect_refused(const std::string& reason) const {
    try {
      (void)read_rlo(file_);
      ADD_FAILURE() << "read what should be refused: " << reason;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
      EXPECT_TRUE(std::string(error.what()).starts_with(file_.string())) << error.what();
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "tree.rlo";
  Cube cube_{Vec3d(-1, 2, 0.5), 3};
};

TEST_F(Rlo, ReadsWhatWasWritten) {
  for (const unsigned depth : {0U, 1U, 2U, 5U, 8U}) {
    for (const bool values : {false, true}) {
      const VoxelBlocks blocks = blocks_of(random_voxels(depth, 2000), values);
      write(depth, blocks);
      const RloFile read = read_rlo(file_);
      const VoxelTree tree = build_tree(cube_, depth, Separating::k6, blocks);
      EXPECT_EQ(read.build_seconds, 1.5);
      EXPECT_EQ(read.tree.cube(), cube_);
      EXPECT_EQ(read.tree.depth(), depth);
      EXPECT_EQ(read.tree.separating(), Separating::k6);
      EXPECT_EQ(read.tree.content(),
                values ? VoxelTree::Content::kRadiosity : VoxelTree::Content::kReflectance);
      EXPECT_TRUE(std::ranges::equal(read.tree.leaves(), tree.leaves()));
      EXPECT_TRUE(std::ranges::equal(read.tree.values(), tree.values()));
      for (unsigned level = 0; level < tree.levels(); ++level)
        EXPECT_TRUE(std::ranges::equal(read.tree.node_values(level), tree.node_values(level)));
      EXPECT_EQ(read.tree.voxels(), tree.voxels());
    }
  }
}

TEST_F(Rlo, PiecesMakeTheSameFile) {
  const auto codes = random_voxels(6, 3000);
  write(6, blocks_of(codes, true));
  const std::string whole = read_file(file_);
  const auto middle = std::ranges::lower_bound(codes, codes[codes.size() / 2] & ~std::uint64_t{63});
  RloWriter writer(file_, cube_, 6, Separating::k6, VoxelTree::Content::kRadiosity);
  writer.add(blocks_of({codes.begin(), middle}, true));
  writer.add(blocks_of({middle, codes.end()}, true));
  writer.finish(1.5);
  EXPECT_TRUE(read_file(file_) == whole);
}

TEST_F(Rlo, EveryAlteredByteIsNoticed) {
  write(4, blocks_of(random_voxels(4, 100), true));
  const std::string good = read_file(file_);
  const auto is_used = [&](std::size_t i) { return good[i] != 0 || i < 280; };
  for (std::size_t i = 0; i < good.size(); i += i < 280 ? 1 : 37) {
    if (!is_used(i)) continue;  // zeros between sections mean nothing
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    write_file(file_, bad);
    EXPECT_THROW((void)read_rlo(file_), FileError) << i;
  }
}

TEST_F(Rlo, TruncatedAndForeignFilesAreRefused) {
  write(6, blocks_of(random_voxels(6, 500), true));
  const std::string good = read_file(file_);
  write_file(file_, good.substr(0, good.size() - 1));
  expect_refused("is truncated or altered");
  write_file(file_, good.substr(0, 100));
  expect_refused("is not a Relumbre octree");
  write_file(file_, "");
  expect_refused("is not a Relumbre octree");
  write_file(file_, good + "x");
  expect_refused("is truncated or altered");
  for (const char version : {'\1', '\3'}) {
    std::string other = good;
    other[8] = version;
    write_file(file_, other);
    expect_refused("version " + std::to_string(version));
  }
  EXPECT_THROW((void)read_rlo(folder_ / "none.rlo"), FileError);
  EXPECT_THROW((void)read_rlo(folder_.path()), FileError);
}

TEST_F(Rlo, NothingIsLeftOfAFileThatWasNotFinished) {
  { RloWriter writer(file_, cube_, 6, Separating::k6); }
  {
    RloWriter writer(file_, cube_, 6, Separating::k6);
    EXPECT_THROW(writer.finish(0), ValueError);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  EXPECT_THROW(RloWriter(folder_ / "none" / "tree.rlo", cube_, 6, Separating::k6), FileError);
}

}  // namespace
}  // namespace relumbre
