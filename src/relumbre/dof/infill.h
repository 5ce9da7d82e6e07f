/// What a foreground hides, guessed from what is seen beside it.
#pragma once

#include <span>

#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

/// For every pixel near something farther away, a surface behind it: the mean colour and depth of
/// the farther pixels around, found in a pyramid in which every cell remembers the mean of its
/// farthest surface. "Near" is as far as blurs reach, given by `circles`, the signed circles of
/// confusion of picture.front. Elsewhere alpha is 0. O(pixels).
PictureLayer fill_behind(const DepthPicture& picture, std::span<const float> circles);

/// The picture with that behind it, for a lens whose blurs are cut at a largest diameter.
DepthPicture infilled(const DepthPicture& picture, const ThinLens& lens, double largest_diameter);

}  // namespace relumbre
