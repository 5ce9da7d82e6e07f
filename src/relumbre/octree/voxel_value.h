/// What a voxel looks like, in eight bytes.
#pragma once

#include <cstdint>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// Colour with a shared exponent and a direction on the octahedron:
///
///   color   | exponent 5 | blue 9 | green 9 | red 9 |    c = mantissa · 2^(exponent - 24)
///   normal  | v 16 | u 16 |                              folded unit octahedron, 0xFFFFFFFF: none
///
/// Colours are linear, within 1/512 of the largest component; the largest is 65,408.
/// Sources: the EXT_texture_shared_exponent specification; Cigolle et al. 2014, "A Survey of
/// Efficient Representations for Independent Unit Vectors".
struct VoxelValue {
  std::uint32_t color = 0;
  std::uint32_t normal = 0xFFFFFFFF;
  friend bool operator==(const VoxelValue&, const VoxelValue&) = default;
};

/// Negative components and NaN become 0, what is too bright the brightest.
std::uint32_t pack_color(const Rgb& color);
Rgb unpack_color(std::uint32_t packed);

/// Of any length; none for zero or what isn't finite.
std::uint32_t pack_normal(const Vec3f& normal);
/// A unit vector, within 1e-4; zero for none.
Vec3f unpack_normal(std::uint32_t packed);

}  // namespace relumbre
