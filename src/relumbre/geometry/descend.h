/// One step, and all steps, down a quadtree of 4-way cuts in barycentric coordinates.
#pragma once

#include <cstddef>
#include <cstdint>

#include "relumbre/base/host_device.h"

namespace relumbre {

/// The child of a triangle under the point with barycentrics (u, v) (weights of corners 1 and 2),
/// numbered as in FacetLocator; (u, v) becomes the child's own. A point on a cut goes to a corner
/// child. The middle child is the triangle turned by half a turn, so its weights are 1 - 2x.
template <class T>
RELUMBRE_HOST_DEVICE inline std::size_t enter_child(T& u, T& v) {
  constexpr T half = T(0.5);
  const std::size_t rest = 1 - u - v >= half ? 0 : 3;
  const std::size_t child = u >= half ? 1 : v >= half ? 2 : rest;
  const bool middle = child == 3;
  u = (middle ? T(-2) : T(2)) * u + (child == 1 ? T(-1) : middle ? T(1) : T(0));
  v = (middle ? T(-2) : T(2)) * v + (child == 2 ? T(-1) : middle ? T(1) : T(0));
  return child;
}

/// Follows blocks of four children (see FacetLocator) from `node` to a negative entry, and returns
/// that. Ends for any (u, v), NaN included.
template <class T>
RELUMBRE_HOST_DEVICE inline std::int32_t descend(const std::int32_t* nodes, std::int32_t node, T& u,
                                                 T& v) {
  while (node >= 0) node = nodes[4 * static_cast<std::size_t>(node) + enter_child(u, v)];
  return node;
}

}  // namespace relumbre
