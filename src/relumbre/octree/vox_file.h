/// MagicaVoxel's file format.
#pragma once

#include <filesystem>

#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

/// MagicaVoxel's world is 2,000 voxels wide; at depth 11 its last ones stand over the edge.
inline constexpr unsigned kMaxVoxDepth = 11;

/// Version 200. Models of at most 256 voxels a side, the octree's nodes at that size, are placed in
/// one scene; z is up, as there. Up to 255 colours, chosen by median cut; grey without values.
/// Throws FileError. Source: ephtracy, "MagicaVoxel .vox file format" and its extension.
void write_vox(const std::filesystem::path& file, const VoxelTree& tree, float exposure);

}  // namespace relumbre
