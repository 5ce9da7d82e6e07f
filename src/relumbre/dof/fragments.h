/// What a picture with depth is made of: pieces of surfaces, each with one blur.
#pragma once

#include <span>
#include <vector>

#include "relumbre/dof/depth_picture.h"
#include "relumbre/dof/fragment.h"

namespace relumbre {

/// One fragment for every pixel of the front, row by row, with these exceptions:
/// - A pixel on a silhouette is a mixture of what lies on either side, of which its depth tells
///   only one. It becomes two fragments, one of either surface, whose colours add up to its own.
/// - What lies behind is one more fragment where a silhouette reveals it.
/// `front` and `behind` (perhaps empty) are signed circles of confusion. O(pixels).
std::vector<Fragment> fragments_of(const DepthPicture& picture, std::span<const float> front,
                                   std::span<const float> behind);

}  // namespace relumbre
