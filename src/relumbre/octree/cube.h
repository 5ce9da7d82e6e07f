/// The cube that an octree divides, and the integer grid in which voxelisation is exact.
///
/// The cube has 2^kGridBits units a side. Vertices are snapped to the nearest unit: a quarter of
/// the resolution that float32 has near the far side. All that follows is integer arithmetic. A
/// voxel at depth D is 2^(kGridBits - D) units wide.
#pragma once

#include <cstdint>

#include "relumbre/base/box.h"
#include "relumbre/base/vec3.h"

namespace relumbre {

inline constexpr unsigned kGridBits = 26;

using GridPoint = Vec3<std::int64_t>;

struct Cube {
  Vec3d corner;     ///< the least one, in metres
  double edge = 1;  ///< in metres

  /// The nearest grid point, within [0, 2^kGridBits] on each axis.
  [[nodiscard]] GridPoint snap(const Vec3f& p) const;
  /// From metres to voxels of depth `depth`.
  [[nodiscard]] Vec3d to_voxels(const Vec3d& p, unsigned depth) const;
  friend bool operator==(const Cube&, const Cube&) = default;
};

/// Centred on the box, as wide as its longest side.
/// Throws ValueError if the box is empty, not finite or a single point.
Cube cube_around(const Box& box);

}  // namespace relumbre
