/// The point set that the rays of every element share, in an order that keeps neighbours together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace relumbre {

/// The first `rays` points of the four-dimensional Sobol' sequence, one coordinate an array.
///
/// Coordinates 0 and 1 choose the point on the surface, 2 and 3 the direction. They are the
/// sequence's dimensions 2, 4, 1 and 3. The six ways to pair them were tried on parallel squares of
/// two triangles each, 400 shifts: this one is best or within 3% of it with 512, 1,024 and 4,096
/// rays, but worst of the six with 256, and on a quarter of the square it has no advantage.
///
/// The points are sorted
/// along the Morton curve of their direction, so that rays next to each other go much the same way;
/// a digital shift (XOR of every coordinate with a constant), which makes each element's rays its
/// own, keeps them so. Arrays are padded with zeros to whole packets of sixteen.
class RayPattern {
 public:
  /// Throws ValueError unless 1 ≤ rays ≤ 2^26. O(rays · log rays), 16 bytes a ray.
  explicit RayPattern(std::uint32_t rays);

  [[nodiscard]] std::uint32_t rays() const { return rays_; }
  [[nodiscard]] std::size_t packets() const { return coordinate_[0].size() / 16; }
  /// Rays in packet p: 16, or fewer in the last.
  [[nodiscard]] std::size_t active(std::size_t p) const {
    const std::size_t left = rays_ - 16 * p;
    return left < 16 ? left : 16;
  }
  [[nodiscard]] const std::uint32_t* coordinate(std::size_t dimension) const {
    return coordinate_[dimension].data();
  }

 private:
  std::uint32_t rays_;
  std::array<std::vector<std::uint32_t>, 4> coordinate_;
};

}  // namespace relumbre
