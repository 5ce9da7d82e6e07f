/// What a voxel looks like from either side, in twelve bytes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// Colours with a shared exponent and a direction on the octahedron:
///
///   color   | exponent 5 | blue 9 | green 9 | red 9 |    c = mantissa · 2^(exponent - 24)
///   back    likewise
///   normal  | v 16 | u 16 |                              folded unit octahedron, 0xFFFFFFFF: none
///
/// `color` is what is seen from where the normal points to, `back` what is seen from the other
/// side: the inside of a lampshade is a hundred times as bright as its outside. Surfaces that face
/// one way have no back, kNoBack, and look the same from behind.
///
/// Colours are linear, within 1/512 of the largest component; the largest is 65,408.
/// Sources: the EXT_texture_shared_exponent specification; Cigolle et al. 2014, "A Survey of
/// Efficient Representations for Independent Unit Vectors".
struct VoxelValue {
  static constexpr std::uint32_t kNoBack = 0x08000000;  ///< an exponent without a mantissa

  std::uint32_t color = 0, back = kNoBack;
  std::uint32_t normal = 0xFFFFFFFF;
  friend bool operator==(const VoxelValue&, const VoxelValue&) = default;
};

/// The mean of surfaces or of voxels, each side for itself. Directions that differ by more than a
/// right angle are of opposite sides, so that the two faces of a thin board do not cancel out.
class VoxelMean {
 public:
  /// Seen from where `normal` points to and, if there is anything to be seen, from behind.
  void add(const Rgb& color, const std::optional<Rgb>& back, const Vec3f& normal, float weight);
  void add(const VoxelMean& other);
  void add(const VoxelValue& voxel);
  /// The normal points to a side that is known.
  [[nodiscard]] VoxelValue value() const;

 private:
  struct Side {
    Rgb color;  ///< times weight
    float weight = 0;
    void add(const Side& s);
  };
  std::array<Side, 2> side_;
  Vec3f normal_;
};

/// What is seen from behind.
Rgb back_color(const VoxelValue& value);

/// Negative components and NaN become 0, what is too bright the brightest.
std::uint32_t pack_color(const Rgb& color);
Rgb unpack_color(std::uint32_t packed);

/// Of any length; none for zero or what isn't finite.
std::uint32_t pack_normal(const Vec3f& normal);
/// A unit vector, within 1e-4; zero for none.
Vec3f unpack_normal(std::uint32_t packed);

}  // namespace relumbre
