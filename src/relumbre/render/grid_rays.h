/// Primary rays of a camera through a cube's grid of voxels.
#pragma once

#include <cmath>

#include "relumbre/octree/tree_cast.h"
#include "relumbre/render/camera_rays.h"

namespace relumbre {

/// From metres to voxels. A hit's t is the planar depth in metres, as CameraRays' is.
class GridRays {
 public:
  /// With nodes of up to `detail` pixels hit as they are: see CastRay. Throws as CameraRays.
  GridRays(const Cube& cube, unsigned depth, const Camera& camera, std::size_t width,
           std::size_t height, double detail = 0)
      : rays_(camera, width, height),
        voxels_per_metre_(std::ldexp(1.0, static_cast<int>(depth)) / cube.edge),
        origin_(cube.to_voxels(Vec3d(camera.eye), depth)),
        spread_(detail / rays_.pixels_per_tangent() * voxels_per_metre_) {}

  [[nodiscard]] CastRay through(float x, float y) const {
    const Ray ray = rays_.through(x, y);
    return {.origin = origin_,
            .direction = Vec3d(ray.direction) * voxels_per_metre_,
            .spread = spread_};
  }
  [[nodiscard]] CastRay through_center(std::size_t x, std::size_t y) const {
    return through(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
  }

 private:
  CameraRays rays_;
  double voxels_per_metre_;
  Vec3d origin_;
  double spread_;
};

}  // namespace relumbre
