/// Writes relit meshes as binary PLY.
#pragma once

#include <filesystem>
#include <span>

#include "relumbre/base/vec3.h"

namespace relumbre {

struct PlyMesh {
  std::span<const Vec3f> positions;
  std::span<const Index3> triangles;
  /// Linear RGB, one a vertex, or empty. Stored as 8-bit sRGB, clamped: apply exposure first.
  std::span<const Rgb> colors = {};
  /// W/m², one a vertex, or empty. Stored as it is.
  std::span<const Rgb> radiosity = {};
};

/// Writes format binary_little_endian 1.0, atomically.
///
///   vertex  float x y z | uchar red green blue, if colours | float radiosity_r _g _b, if radiosity
///   face    uchar 3 | int vertex_indices ×3
///
/// Throws ShapeError if the sizes disagree or an index is out of range, FileError.
/// Source: Turk 1994, "The PLY Polygon File Format".
void write_ply(const std::filesystem::path& path, const PlyMesh& mesh);

}  // namespace relumbre
