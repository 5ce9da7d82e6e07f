/// Voxels as points in a PLY file.
#pragma once

#include <filesystem>

#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

/// format binary_little_endian 1.0, in the order of Morton codes:
///
///   vertex  float x y z | with values: uchar red green blue, float nx ny nz
///
/// Throws FileError. Source: Turk 1994, "The PLY Polygon File Format".
void write_points(const std::filesystem::path& file, const VoxelTree& tree, float exposure);

}  // namespace relumbre
