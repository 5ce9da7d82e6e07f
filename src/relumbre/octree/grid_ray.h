/// What it means that a ray hits a cell of a grid: one definition for every traversal, so that all
/// of them return the same voxel, bit for bit.
///
/// Grid coordinates: the cube is [0, 2^D]³, a cell's planes are integers. A ray passes plane k of
/// an axis at
///
///   t(k) = (k - o) · (1/d)                              always by this expression
///
/// A cell's interval is [enter, exit]: enter = the largest of 0 and each axis's smaller t, exit =
/// the smallest of each axis's larger t. The ray *pierces* the cell if enter < exit: a touched
/// face, edge or corner does not count. The hit is the pierced voxel with the smallest enter.
///
/// Parallel to an axis (1/d is not finite: |d| up to about 2^-1024): the cell is pierced only if o
/// lies in the half-open [k, k + size). That is the same expression with 1/d = +∞ and floor(o) +
/// 1/2 for o: t = -∞ where k ≤ o and +∞ where k > o.
///
/// Why the hit is unique: rounding is monotone, hence t is monotone in k. So a cell's interval lies
/// within that of any cell around it, and of two cells that plane k separates one ends by t(k) and
/// the other begins there: pierced cells share no open interval, whatever structure holds them.
/// Moreover the intervals [enter, exit) of 8 octants partition that of their parent.
///
/// Rays that are not finite hit nothing. So do rays from so far that the planes of a cell round to
/// one t. A direction needs no unit length (t is in units of it); one of length 0 hits the voxel
/// that holds its origin.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "relumbre/base/host_device.h"
#include "relumbre/base/vec3.h"
#include "relumbre/octree/morton.h"

namespace relumbre {

/// Of a ray in a cell.
struct RayInterval {
  double enter = 0, exit = 0;
  [[nodiscard]] RELUMBRE_HOST_DEVICE bool is_pierced() const { return enter < exit; }
};

class GridRay {
 public:
  /// One that hits nothing.
  GridRay() = default;
  RELUMBRE_HOST_DEVICE GridRay(const Vec3d& origin, const Vec3d& direction) {
    if (!is_finite(origin) || !is_finite(direction)) return;
    for (std::size_t axis = 0; axis < 3; ++axis) set_axis(axis, origin[axis], direction[axis]);
  }

  /// Where the ray passes a plane. Never NaN; -∞ or +∞ if it is parallel.
  [[nodiscard]] RELUMBRE_HOST_DEVICE Vec3d t(const Vec3d& planes) const {
    return (planes - origin_) * inverse_;
  }

  /// Of the cell with this corner, in cells of the deepest level, and this edge.
  [[nodiscard]] RELUMBRE_HOST_DEVICE RayInterval interval(const Cell& lower,
                                                          std::uint32_t size) const {
    const Vec3d a = t(at(lower)), b = t(at({lower.x + size, lower.y + size, lower.z + size}));
    const Vec3d near = min(a, b), far = max(a, b);
    return {std::max(0.0, max_component(near)), std::min(far.x, std::min(far.y, far.z))};
  }

  /// The same exit as interval()'s.
  [[nodiscard]] RELUMBRE_HOST_DEVICE double exit(const Cell& lower, std::uint32_t size) const {
    const Vec3d far =
        t(at({lower.x + (sign_mask_ & 1U ? 0 : size), lower.y + (sign_mask_ & 2U ? 0 : size),
              lower.z + (sign_mask_ & 4U ? 0 : size)}));
    return std::min(far.x, std::min(far.y, far.z));
  }

  /// The octant, around a centre, that the ray is in at `now`: the one with enter <= now < exit,
  /// given that this holds for their parent.
  [[nodiscard]] RELUMBRE_HOST_DEVICE unsigned octant_at(const Cell& center, double now) const {
    const Vec3d middle = t(at(center));
    const unsigned passed =
        unsigned{middle.x <= now} | unsigned{middle.y <= now} << 1 | unsigned{middle.z <= now} << 2;
    return passed ^ sign_mask_;
  }

  /// The axis of the face through which the ray comes into a cell that it pierces, the first of
  /// several; -1 if it starts inside.
  [[nodiscard]] RELUMBRE_HOST_DEVICE int entered_axis(const Cell& lower, std::uint32_t size) const {
    const double enter = interval(lower, size).enter;
    const Vec3d a = t(at(lower)), b = t(at({lower.x + size, lower.y + size, lower.z + size}));
    const Vec3d near = min(a, b);
    return near.x == enter ? 0 : near.y == enter ? 1 : near.z == enter ? 2 : -1;
  }

  /// What t() is computed from: beside a parallel axis, a point in the same cells.
  [[nodiscard]] RELUMBRE_HOST_DEVICE const Vec3d& origin() const { return origin_; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE const Vec3d& inverse() const { return inverse_; }

  /// Bit a is set if the ray goes down along axis a. Octants are passed in order of
  /// octant XOR sign mask.
  [[nodiscard]] RELUMBRE_HOST_DEVICE unsigned sign_mask() const { return sign_mask_; }

 private:
  RELUMBRE_HOST_DEVICE static Vec3d at(const Cell& corner) {
    return {static_cast<double>(corner.x), static_cast<double>(corner.y),
            static_cast<double>(corner.z)};
  }

  RELUMBRE_HOST_DEVICE void set_axis(std::size_t axis, double origin, double direction) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double inverse = 1 / direction;
    const bool is_parallel = !std::isfinite(inverse);
    // Planes are integers: k <= o exactly where k < floor(o) + 1/2, which is never 0 · ∞.
    origin_[axis] = is_parallel ? std::floor(origin) + 0.5 : origin;
    inverse_[axis] = is_parallel ? kInfinity : inverse;
    if (!is_parallel && inverse < 0) sign_mask_ |= 1U << axis;
  }

  // Beside the cube and parallel to everything: no cell is pierced.
  Vec3d origin_{-1.0}, inverse_{std::numeric_limits<double>::infinity()};
  unsigned sign_mask_ = 0;
};

/// The first voxel that a ray pierces.
struct VoxelHit {
  Cell cell{};
  double t = 0;   ///< where the ray enters it, 0 if it starts inside
  int axis = -1;  ///< whose face it enters through; -1 if it starts inside
  friend bool operator==(const VoxelHit&, const VoxelHit&) = default;
};

/// The hit if this were the only voxel, or the only node of so many voxels an edge.
inline std::optional<VoxelHit> intersect_voxel(const GridRay& ray, const Cell& cell,
                                               std::uint32_t size = 1) {
  const RayInterval interval = ray.interval(cell, size);
  if (!interval.is_pierced()) return std::nullopt;
  return VoxelHit{cell, interval.enter, ray.entered_axis(cell, size)};
}

}  // namespace relumbre
