/// Depth of field by gathering: the seed method and the baseline of the others.
#pragma once

#include <vector>

#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

/// Every pixel is the mean of the square around it whose side is its circle of confusion, at most
/// `largest_diameter` pixels, from one summed-area table. In time that does not depend on the blur.
/// It knows nothing of silhouettes: what is sharp bleeds into what is blurred behind it, and a
/// blurred foreground keeps its hard outline. Throws as spread().
std::vector<Rgba> gather(const DepthPicture& picture, const ThinLens& lens,
                         double largest_diameter = 512);

}  // namespace relumbre
