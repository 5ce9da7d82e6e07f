/// Rays through a Bvh: one piece of code for CPU and GPU.
///
/// Watertight. Boxes are widened by what rounding can do to them, so that none is missed. Triangles
/// are tested in the ray's own sheared coordinates (Woop, Benthin and Wald 2013), and an edge's
/// side is found without error there, so that of two triangles that share it at least one is hit:
/// their method falls back to double precision for that, here it is done with fused multiply-adds.
///
/// The closest hit does not depend on the order of traversal: of several at the same distance it is
/// the triangle with the smallest index. CPU and GPU do the same operations with the same rounding.
/// Source of the traversal: Ylitie, Karras and Laine 2017, §4.
#pragma once

#include <cstdint>

#include "relumbre/base/device_math.h"
#include "relumbre/base/host_device.h"
#include "relumbre/visibility/bvh.h"

namespace relumbre {

/// Where a Bvh lies, in the memory of the side that traverses it.
struct BvhView {
  const BvhNode* nodes;
  const BvhTriangle* triangles;
};

/// Laid out like Ray.
struct alignas(16) BvhRay {
  float origin_x, origin_y, origin_z, t_min;
  float direction_x, direction_y, direction_z, t_max;
};

/// Sixteen bytes. The members of Hit, `back` being the highest bit of `side`.
struct alignas(16) BvhHit {
  std::uint32_t side;  ///< triangle | back << 31, or kMiss
  float t, u, v;

  static constexpr std::uint32_t kMiss = 0xFFFFFFFFU;
  [[nodiscard]] RELUMBRE_HOST_DEVICE bool hit() const { return side != kMiss; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::uint32_t triangle() const { return side & 0x7FFFFFFFU; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE bool back() const { return (side >> 31) != 0; }
};

namespace bvh {

/// What is computed once a ray.
struct Prepared {
  float x, y, z;                          ///< the origin
  float inverse_x, inverse_y, inverse_z;  ///< 1 / direction, bounded
  float shear_x, shear_y, shear_z;        ///< across the main axis; 1 / direction along it
  std::uint32_t axis;                     ///< main axis: the direction's largest component
  std::uint32_t forward;                  ///< bit k: the inverse's component k is positive
  float t_min;
};

/// Rounding moves what is computed of a node or triangle by less than this share of its distance.
inline constexpr float kSlack = 0x1p-20F;
/// And by less than this share of a cell, since cells are numbered from 2^15 on: see cell().
inline constexpr float kCellSlack = 0x1p-8F;
inline constexpr float kFirstCell = 0x1p15F;

RELUMBRE_HOST_DEVICE inline float pick(std::uint32_t axis, float x, float y, float z) {
  return axis == 0 ? x : axis == 1 ? y : z;
}

/// 1 / d; a component so small that it moves a ray by less than rounding does is taken for larger.
RELUMBRE_HOST_DEVICE inline float bounded_inverse(float d, float largest) {
  const float smallest = largest * 0x1p-24F;
  return 1.0F / (::fabsf(d) > smallest ? d : ::copysignf(smallest, d));
}

RELUMBRE_HOST_DEVICE inline bool bounded(float value) { return ::fabsf(value) <= 1e30F; }

/// False for a ray that goes nowhere: such a one hits nothing.
RELUMBRE_HOST_DEVICE inline bool prepare(const BvhRay& ray, Prepared& out) {
  const float dx = ray.direction_x, dy = ray.direction_y, dz = ray.direction_z;
  const float ax = ::fabsf(dx), ay = ::fabsf(dy), az = ::fabsf(dz);
  out.axis = az >= ax && az >= ay ? 2U : ay >= ax ? 1U : 0U;
  const float largest = larger(az, larger(ay, ax));
  const float along = pick(out.axis, dx, dy, dz);
  out.x = ray.origin_x, out.y = ray.origin_y, out.z = ray.origin_z;
  out.inverse_x = bounded_inverse(dx, largest);
  out.inverse_y = bounded_inverse(dy, largest);
  out.inverse_z = bounded_inverse(dz, largest);
  out.shear_x = pick(out.axis, dy, dz, dx) / along;
  out.shear_y = pick(out.axis, dz, dx, dy) / along;
  out.shear_z = 1.0F / along;
  out.forward =
      (out.inverse_x > 0 ? 1U : 0U) | (out.inverse_y > 0 ? 2U : 0U) | (out.inverse_z > 0 ? 4U : 0U);
  out.t_min = ray.t_min;
  return largest >= 1e-30F && bounded(dx) && bounded(dy) && bounded(dz) && bounded(out.x) &&
         bounded(out.y) && bounded(out.z);
}

/// What of a node a ray is to visit.
struct Met {
  std::uint32_t bits;  ///< see BvhNode; nodes' bits are in the order in which to visit them
  std::uint32_t first_child, first_triangle, inner;
};

/// Byte i of a word as the number 2^15 + byte: half the work of a conversion.
RELUMBRE_HOST_DEVICE inline float cell(std::uint32_t word, std::uint32_t i) {
#if defined(__CUDA_ARCH__)
  return __uint_as_float(__byte_perm(word, 0x47000000U, 0x7404U + (i << 4)));
#else
  return float_of_bits(0x47000000U | ((word >> (8 * i)) & 0xFFU) << 8);
#endif
}

/// The times at which a ray crosses planes of the grid, along one axis: cell · step + near or far.
struct Planes {
  float step, near, far;
};

RELUMBRE_HOST_DEVICE inline float cell_side(std::uint32_t exponents, std::uint32_t axis) {
  return float_of_bits((exponents >> (8 * axis) & 0xFFU) << 23);
}

/// `distance`: of anything in the node from the ray's origin, at the most.
RELUMBRE_HOST_DEVICE inline Planes planes(float to_origin, float side, float inverse,
                                          float distance) {
  const float step = side * inverse;
  const float first = fused(-kFirstCell, step, to_origin * inverse);
  const float slack = fused(::fabsf(inverse), distance * kSlack, ::fabsf(step) * kCellSlack);
  return {step, first - slack, first + slack};
}

/// The bits of four children whose first and last crossings lie in the lanes of these words.
RELUMBRE_HOST_DEVICE inline std::uint32_t meet_four(const Planes& x, const Planes& y,
                                                    const Planes& z, const std::uint32_t (&near)[3],
                                                    const std::uint32_t (&far)[3],
                                                    std::uint32_t meta, std::uint32_t forward,
                                                    float t_min, float t_max) {
  // Nodes' bits are turned so that the highest is the nearest.
  const std::uint32_t node = (meta & (meta << 1)) & 0x10101010U;
  const std::uint32_t index = (meta ^ ((node >> 4) * forward)) & 0x1F1F1F1FU;
  std::uint32_t bits = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const float enters = larger(
        larger(fused(cell(near[0], i), x.step, x.near), fused(cell(near[1], i), y.step, y.near)),
        larger(fused(cell(near[2], i), z.step, z.near), t_min));
    const float leaves = smaller(
        smaller(fused(cell(far[0], i), x.step, x.far), fused(cell(far[1], i), y.step, y.far)),
        smaller(fused(cell(far[2], i), z.step, z.far), t_max));
    const std::uint32_t child = (meta >> (8 * i + 5)) & 7U;
    bits |= (enters > leaves ? 0U : child) << ((index >> (8 * i)) & 31U);
  }
  return bits;
}

RELUMBRE_HOST_DEVICE inline Met meet(const BvhNode* node, const Prepared& ray, float t_max) {
  const auto* words = reinterpret_cast<const Words4*>(node);
  const Words4 grid = load_words(words), what = load_words(words + 1),
               lower_xy = load_words(words + 2), mixed = load_words(words + 3),
               upper_yz = load_words(words + 4);
  const float x = float_of_bits(grid.x) - ray.x, y = float_of_bits(grid.y) - ray.y,
              z = float_of_bits(grid.z) - ray.z;
  const float side_x = cell_side(grid.w, 0), side_y = cell_side(grid.w, 1),
              side_z = cell_side(grid.w, 2);
  const float distance = fused(larger(larger(side_x, side_y), side_z), 256.0F,
                               larger(larger(::fabsf(x), ::fabsf(y)), ::fabsf(z)));
  const Planes px = planes(x, side_x, ray.inverse_x, distance),
               py = planes(y, side_y, ray.inverse_y, distance),
               pz = planes(z, side_z, ray.inverse_z, distance);
  const bool fx = (ray.forward & 1U) != 0, fy = (ray.forward & 2U) != 0,
             fz = (ray.forward & 4U) != 0;
  const std::uint32_t near_0[3] = {fx ? lower_xy.x : mixed.z, fy ? lower_xy.z : upper_yz.x,
                                   fz ? mixed.x : upper_yz.z};
  const std::uint32_t far_0[3] = {fx ? mixed.z : lower_xy.x, fy ? upper_yz.x : lower_xy.z,
                                  fz ? upper_yz.z : mixed.x};
  const std::uint32_t near_1[3] = {fx ? lower_xy.y : mixed.w, fy ? lower_xy.w : upper_yz.y,
                                   fz ? mixed.y : upper_yz.w};
  const std::uint32_t far_1[3] = {fx ? mixed.w : lower_xy.y, fy ? upper_yz.y : lower_xy.w,
                                  fz ? upper_yz.w : mixed.y};
  const std::uint32_t bits =
      meet_four(px, py, pz, near_0, far_0, what.z, ray.forward, ray.t_min, t_max) |
      meet_four(px, py, pz, near_1, far_1, what.w, ray.forward, ray.t_min, t_max);
  return {bits, what.x, what.y, grid.w >> 24};
}

/// A corner in the ray's coordinates: the ray runs along z from 0. z is yet to be scaled.
struct Corner {
  float x, y, z;
};

RELUMBRE_HOST_DEVICE inline Corner shear(const Words4& corner, const Prepared& ray) {
  const float x = float_of_bits(corner.x) - ray.x, y = float_of_bits(corner.y) - ray.y,
              z = float_of_bits(corner.z) - ray.z;
  const float along = pick(ray.axis, x, y, z);
  return {fused(-ray.shear_x, along, pick(ray.axis, y, z, x)),
          fused(-ray.shear_y, along, pick(ray.axis, z, x, y)), along};
}

/// Replaces `best` by the hit on the triangle if that is closer; true if so.
RELUMBRE_HOST_DEVICE inline bool keep_closer(const BvhTriangle* triangle, const Prepared& ray,
                                             BvhHit& best) {
  const auto* words = reinterpret_cast<const Words4*>(triangle);
  const Words4 first = load_words(words);
  const Corner a = shear(first, ray), b = shear(load_words(words + 1), ray),
               c = shear(load_words(words + 2), ray);
  // Twice the areas that the ray's point spans with the edges across from a, b and c.
  const float across_a = difference_of_products(c.x, b.y, c.y, b.x);
  const float across_b = difference_of_products(a.x, c.y, a.y, c.x);
  const float across_c = difference_of_products(b.x, a.y, b.y, a.x);
  const bool any_negative = across_a < 0 || across_b < 0 || across_c < 0;
  const bool any_positive = across_a > 0 || across_b > 0 || across_c > 0;
  if (any_negative == any_positive) return false;  // outside, or edge-on

  const float whole = across_a + across_b + across_c;
  const float u = across_b / whole, v = across_c / whole;
  const float t = ray.shear_z * fused(across_a / whole, a.z, fused(u, b.z, v * c.z));
  if (!(t > ray.t_min && t <= best.t)) return false;
  if (t == best.t && best.hit() && best.triangle() < first.w) return false;
  const bool back = (whole < 0) == (ray.shear_z > 0);
  best = {first.w | (back ? 0x80000000U : 0U), t, u, v};
  return true;
}

/// Nodes yet to visit: the children of one node that a ray meets.
struct Group {
  std::uint32_t first_child;
  std::uint32_t bits;  ///< their bits in the upper 8, BvhNode::inner in the lower 8
};

}  // namespace bvh

/// The closest hit, or with `kAny` some hit. t is in (t_min, t_max]. A ray whose origin or
/// direction is not finite or beyond 10^30, or whose direction is shorter than 10^-30, hits
/// nothing.
template <bool kAny>
RELUMBRE_HOST_DEVICE inline BvhHit trace(const BvhView& scene, const BvhRay& query) {
  constexpr float kFarthest = 3.402823466e38F;
  BvhHit best{BvhHit::kMiss, smaller(query.t_max, kFarthest), 0, 0};
  bvh::Prepared ray;
  if (!bvh::prepare(query, ray)) return best;
  bvh::Group stack[Bvh::kMaxDepth];  // a node pushes one group at the most
  std::uint32_t height = 0, node = 0;
  bvh::Group group{0, 0};
  for (;;) {
    const bvh::Met met = bvh::meet(scene.nodes + node, ray, best.t);
    for (std::uint32_t bits = met.bits & 0xFFFFFFU; bits != 0; bits &= bits - 1) {
      const bool hit =
          bvh::keep_closer(scene.triangles + (met.first_triangle + lowest_bit(bits)), ray, best);
      if (kAny && hit) return best;
    }
    if (met.bits >> 24 != 0) {
      if (group.bits >> 24 != 0) stack[height++] = group;
      group = {met.first_child, (met.bits & 0xFF000000U) | met.inner};
    } else if (group.bits >> 24 == 0) {
      if (height == 0) return best;
      group = stack[--height];
    }
    // On to the group's nearest node.
    const std::uint32_t bit = highest_bit(group.bits);
    group.bits ^= 1U << bit;
    const std::uint32_t slot = (bit - 24) ^ ray.forward;
    node = group.first_child + bit_count(group.bits & 0xFFU & ~(~0U << slot));
  }
}

}  // namespace relumbre
