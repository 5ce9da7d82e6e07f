/// What a voxel that was hit looks like.
#pragma once

#include "relumbre/octree/tree_cast.h"

namespace relumbre {

enum class VoxelShading {
  kLit,     ///< colour under a lamp at the eye and a uniform sky; grey where there are no colours
  kColor,   ///< colour as it is: what a tree of radiosity should be shown by
  kNormal,  ///< the normal, (n + 1) / 2 of each component
};

class VoxelShader {
 public:
  /// `smooth`: between the eight cells around the point that is hit, of voxels or of nodes as large
  /// as the one that is hit.
  VoxelShader(const VoxelTree& tree, VoxelShading shading, bool smooth)
      : tree_(tree), shading_(shading), smooth_(smooth) {}

  [[nodiscard]] Rgb color(const CastRay& ray, const TreeHit& hit) const;
  /// Facing the ray; that of the face it came in by where the tree has none.
  [[nodiscard]] Vec3f normal(const CastRay& ray, const TreeHit& hit) const;

 private:
  struct Look {
    Rgb color;
    Vec3f normal;
  };
  [[nodiscard]] Look look(const CastRay& ray, const TreeHit& hit) const;
  /// From the ray's side.
  [[nodiscard]] Look stored(const CastRay& ray, const VoxelTree::Child& child) const;
  [[nodiscard]] Look interpolated(const CastRay& ray, const TreeHit& hit) const;

  const VoxelTree& tree_;
  VoxelShading shading_;
  bool smooth_;
};

}  // namespace relumbre
