/// A part of the grid, 64 voxels a side, that fits a processor's cache.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/octree/voxelize.h"

namespace relumbre {

/// Fills one brick after another; a thread has one.
class BrickFiller {
 public:
  static constexpr unsigned kDepth = 6;  ///< levels in a brick

  BrickFiller(const TriangleMesh& mesh, const Cube& cube, const VoxelizeConfig& config);

  /// The brick with this Morton code, and the triangles that may cover voxels of it.
  VoxelBlocks fill(std::uint64_t code, std::span<const std::uint32_t> triangles);

 private:
  struct Hit {
    std::uint32_t voxel;  // its Morton code in the brick
    std::uint32_t triangle;
  };
  static constexpr std::size_t kBlocks = std::size_t{1} << (3 * (kDepth - VoxelBlocks::kDepth));

  void cover(const GridPoint& lower, std::uint32_t triangle);
  VoxelBlocks collect(std::uint64_t code);
  std::vector<VoxelValue> values(const GridPoint& lower, std::size_t voxels);
  void add_to_mean(const GridPoint& lower, const Hit& hit);
  void clear(const VoxelBlocks& blocks);

  const TriangleMesh& mesh_;
  const Cube& cube_;
  const VoxelizeConfig& config_;
  std::vector<std::uint64_t> masks_;  // of all blocks
  std::vector<std::uint32_t> first_;  // rank of each block's first voxel
  std::vector<Hit> hits_;
  std::vector<VoxelMean> means_;
};

/// A triangle of the mesh on the cube's grid.
GridTriangle grid_triangle(const TriangleMesh& mesh, const Cube& cube, std::size_t triangle);

}  // namespace relumbre
