/// The octree's file, `.rlo`: docs/rlo.md has it byte by byte.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "relumbre/octree/voxel_blocks.h"
#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

/// What a file says of the tree beside the tree itself.
struct RloFile {
  VoxelTree tree;
  double build_seconds = 0;
};

/// Maps the file into memory, which the tree then shares: nothing is copied. All of it is read
/// once to compare its hashes and to check the tree. The file must not be changed while the tree
/// lives. Throws FileError for what is no such file, truncated, damaged or of another version.
RloFile read_rlo(const std::filesystem::path& file);

/// The same of bytes in memory, aligned to 8, that `owner` keeps; `name` is for errors.
RloFile view_rlo(std::span<const std::byte> bytes, std::shared_ptr<const void> owner,
                 const std::string& name);

/// Writes a tree while it is built. Values go to the file as they come; the masks and one value a
/// node, about a byte a voxel, stay in memory until the end. The file appears whole or not at all.
class RloWriter {
 public:
  /// Throws FileError if the folder cannot be written to.
  RloWriter(const std::filesystem::path& file, const Cube& cube, unsigned depth,
            Separating separating, VoxelTree::Content content = VoxelTree::Content::kReflectance);
  ~RloWriter();

  /// As VoxelTreeBuilder::add(). A full disk is noticed here or in finish(): FileError.
  void add(const VoxelBlocks& blocks);
  /// Throws ValueError if there were no voxels.
  void finish(double build_seconds);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relumbre
