#include "relumbre/octree/voxel_export.h"

#include <cmath>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/octree/point_file.h"
#include "relumbre/octree/vox_file.h"

namespace relumbre {

void export_voxels(const std::filesystem::path& file, const VoxelTree& tree, float exposure) {
  check_export(file, tree.depth());
  if (file.extension() == ".vox")
    write_vox(file, tree, exposure);
  else
    write_points(file, tree, exposure);
}

void check_export(const std::filesystem::path& file, unsigned depth) {
  if (file.extension() != ".vox" && file.extension() != ".ply")
    throw FileError(file.string(), "cannot be written: voxels are exported as .vox and .ply");
  if (file.extension() == ".vox" && depth > kMaxVoxDepth) {
    throw FileError(file.string(), "cannot be written: MagicaVoxel has room for depth " +
                                       std::to_string(kMaxVoxDepth) + ", not " +
                                       std::to_string(depth));
  }
}

}  // namespace relumbre
