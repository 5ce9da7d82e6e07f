/// The outlines that blurs have.
#pragma once

#include <vector>

#include "relumbre/image/thin_lens.h"

namespace relumbre {

/// The outline of every blur.
enum class BlurShape {
  kBox,       ///< a square of the disc's area, along the rows
  kAperture,  ///< the lens's own: a disc, or a polygon of so many blades
};

struct Vec2d {
  double x = 0, y = 0;
};
using OutlineCorners = std::vector<Vec2d>;

/// Corners of the blur of diameter 1 around (0, 0), of what lies behind the plane in focus; y grows
/// downwards, as rows do. None: a disc. Throws what Aperture::check() throws.
OutlineCorners outline_corners(BlurShape shape, const Aperture& aperture);

}  // namespace relumbre
