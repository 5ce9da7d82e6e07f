/// The traversal of the simulated machine's geometry unit (GT), whose reads are counted.
///
///   push the root
///   forever
///     pop a task {location code, centre of the parent's box}      none left: no hit
///     the ray misses the node's box?                              next
///     a voxel?                                                    it is the nearest hit
///     read the node's word
///     push its non-empty children, the farthest first: by octant XOR sign mask
///
/// full_stack.h does the same with another notion of a hit: there, cells are half-open along the
/// ray, so that every traversal finds the same voxel. Here a box is *closed*, by Algorithm 1 of the
/// thesis, and more boxes are entered: those that a ray but touches. Reads of the machine are
/// counted with this one.
///
/// Algorithm 1, for a box [lower, upper], in float64, from an interval of [0, ∞):
///
///   for each axis   near = (lower - o) / d, far = (upper - o) / d, exchanged if near > far
///                   the box is missed if tmin > far or near > tmax
///                   tmin = max(tmin, near), tmax = min(tmax, far)
///   in the end      the box is missed if tmax < 0, or tmin = ∞ (the interval is half-open)
///
/// What the definition leaves open, and what is done:
///   - the text compares the first axis's tmin with its own tmax where the second axis's is meant
///     (`tmin > tmax || tymin > tmax`): as above, for all axes alike;
///   - "closed": all comparisons are strict, as in the text, so that a ray that touches a face, an
///     edge or a corner hits. A voxel touched only so ends the ray, too;
///   - 0/0, where a ray runs within a plane of the box: the text's comparisons with NaN are all
///     false, which ignores the axis, but on the first axis makes NaN of tmin, and with d = -0 they
///     may miss. Here that axis never separates: the ray is within the closed slab;
///   - equal distances: of children that are entered at the same t the order of
///     octant XOR sign mask decides; a component of ±0 is not negative;
///   - the text narrows the ray's interval to the box that is hit and hands it to the children. A
///     child's planes are its parent's or lie between them, and rounding is monotone, so that this
///     never changes a result; each box begins anew with [0, ∞);
///   - coordinates: in voxels of the deepest level (Cube::to_voxels), in which centres and planes
///     of boxes are integers: exact. The direction needs no unit length;
///   - a ray that is not finite or has no direction pops the root and misses it.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "relumbre/base/vec3.h"
#include "relumbre/octree/octree.h"
#include "relumbre/octree/task_stack.h"
#include "relumbre/octree/traversal_observer.h"

namespace relumbre {

/// Where the ray meets a box, or the nearest voxel. May be a single point.
struct GeometryHit {
  LocationCode code = 0;
  double t = 0;  ///< where the ray enters it, 0 if it starts inside
  friend bool operator==(const GeometryHit&, const GeometryHit&) = default;
};

namespace geometry_unit_detail {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct UnitRay {
  Vec3d origin, direction;

  [[nodiscard]] bool is_valid() const {
    return is_finite(origin) && is_finite(direction) && !(direction == Vec3d(0));
  }
  [[nodiscard]] unsigned sign_mask() const {
    return unsigned{direction.x < 0} | unsigned{direction.y < 0} << 1 |
           unsigned{direction.z < 0} << 2;
  }
};

/// One axis of Algorithm 1. False if the box is missed.
inline bool clip(double lower, double upper, double origin, double direction, double& tmin,
                 double& tmax) {
  double near = (lower - origin) / direction, far = (upper - origin) / direction;
  if (near > far) std::swap(near, far);
  if (std::isnan(near) || std::isnan(far)) return true;  // 0/0
  if (tmin > far || near > tmax) return false;
  if (near > tmin) tmin = near;
  if (far < tmax) tmax = far;
  return true;
}

/// Algorithm 1: where the ray enters the closed box, if it meets it.
inline std::optional<double> intersect(const UnitRay& ray, const Cell& lower, std::uint32_t size) {
  const auto at = [](std::uint32_t plane) { return static_cast<double>(plane); };
  const Vec3d &o = ray.origin, &d = ray.direction;
  double tmin = -kInfinity, tmax = kInfinity;
  if (!clip(at(lower.x), at(lower.x + size), o.x, d.x, tmin, tmax)) return std::nullopt;
  if (!clip(at(lower.y), at(lower.y + size), o.y, d.y, tmin, tmax)) return std::nullopt;
  if (!clip(at(lower.z), at(lower.z + size), o.z, d.z, tmin, tmax)) return std::nullopt;
  if (tmin == kInfinity || tmax < 0) return std::nullopt;
  return tmin > 0 ? tmin : 0;
}

/// Uninitialised by default, for the stack.
struct Task {
  LocationCode code;
  Cell parent_center;
  Octree::Index index;  ///< of the node's word; means nothing for a voxel
};

/// ExtractOctantCenterFromParentCenter, or rather the octant's corner of least coordinates.
inline Cell lower_corner(const Cell& parent_center, unsigned octant, std::uint32_t size) {
  return {parent_center.x - (octant & 1U ? 0 : size), parent_center.y - (octant & 2U ? 0 : size),
          parent_center.z - (octant & 4U ? 0 : size)};
}

}  // namespace geometry_unit_detail

/// The nearest voxel that the ray meets, in the order above. Origin and direction in voxels of the
/// deepest level. Visits: tasks popped, voxels too, met or not: some 4 for each node that is read,
/// of up to 6 divisions each.
template <TraversalObserver Observer = NoObserver>
std::optional<GeometryHit> trace_geometry_unit(const Octree& octree, const Vec3d& origin,
                                               const Vec3d& direction, Observer&& observer = {}) {
  using namespace geometry_unit_detail;
  observer.begin_ray(GridRay(origin, direction));
  const UnitRay ray{origin, direction};
  const unsigned sign_mask = ray.sign_mask();
  const int depth = octree.depth();
  // The root is octant 7 of a parent whose centre is the cube's corner.
  TaskStack<Task> lifo;
  lifo.push({kRootCode, {0, 0, 0}, 0});
  while (!lifo.empty()) {
    const Task task = lifo.pop();
    const int level = level_of(task.code);
    observer.visit(task.code, level);
    const std::uint32_t size = 1U << (depth - level);
    const unsigned octant = level == 0 ? 7 : octant_of(task.code);
    const Cell lower = lower_corner(task.parent_center, octant, size);
    const std::optional<double> t = ray.is_valid() ? intersect(ray, lower, size) : std::nullopt;
    if (!t) continue;
    if (level == depth) return GeometryHit{task.code, *t};
    observer.read(task.code, level);
    const std::uint32_t half = size / 2;
    const Cell center{lower.x + half, lower.y + half, lower.z + half};
    push_children(lifo, octree, task.index, sign_mask, [&](unsigned child, Octree::Index index) {
      return Task{child_of(task.code, child), center, index};
    });
  }
  return std::nullopt;
}

}  // namespace relumbre
