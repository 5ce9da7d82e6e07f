/// Voxels for other programs.
#pragma once

#include <filesystem>

#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

/// By the file's extension, atomically; colours are multiplied by `exposure`, then sRGB, clamped.
///   .vox   MagicaVoxel: up to depth 11; see vox_file.h
///   .ply   binary points in metres, the voxels' centres; colour and normal where there are any
/// Throws FileError.
void export_voxels(const std::filesystem::path& file, const VoxelTree& tree, float exposure = 1);

/// Throws FileError unless export_voxels() can write such a file at this depth.
void check_export(const std::filesystem::path& file, unsigned depth);

}  // namespace relumbre
