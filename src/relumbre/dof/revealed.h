/// Which hidden pixels a lens sees round a silhouette.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/dof/depth_picture.h"
#include "relumbre/dof/surface_edges.h"

namespace relumbre {

/// 1 for every pixel whose hidden surface some point of the lens sees past a silhouette of the
/// front. Seen from the rim of the lens, what lies behind has moved against the front by half the
/// difference of their circles of confusion, `front` and `behind` (signed diameters, pixels); so
/// no silhouette that is farther away reveals it, nor one past which only nearer things are seen.
/// 0 where it is not known what lies behind. O(pixels).
/// `edges`: of `front`.
std::vector<std::uint8_t> revealed(const DepthPicture& picture, const SurfaceEdges& edges,
                                   std::span<const float> front, std::span<const float> behind);

}  // namespace relumbre
