/// World-space triangle meshes: the geometry that rays see.
#pragma once

#include <cstdint>
#include <vector>

#include "relumbre/base/box.h"
#include "relumbre/base/vec3.h"

namespace relumbre {

/// Index-based triangles in metres, counter-clockwise seen from the front.
/// Per-triangle arrays have one entry a triangle.
struct TriangleMesh {
  std::vector<Vec3f> positions;
  std::vector<Index3> triangles;
  std::vector<std::uint32_t> material;  ///< per triangle, index into Scene::materials
  std::vector<std::uint32_t> object;    ///< per triangle, index into Scene::objects
  std::vector<std::uint8_t> two_sided;  ///< per triangle, 1 where the back reflects too

  [[nodiscard]] Vec3f corner(std::size_t triangle, std::size_t vertex) const {
    return positions[triangles[triangle][vertex]];
  }
  /// Twice the area times the unit normal.
  [[nodiscard]] Vec3f scaled_normal(std::size_t triangle) const {
    const Vec3f a = corner(triangle, 0);
    return cross(corner(triangle, 1) - a, corner(triangle, 2) - a);
  }
};

}  // namespace relumbre
