/// Depth of field by spreading: every pixel's light is shared out among its neighbours.
#pragma once

#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/dof/aperture_kernel.h"
#include "relumbre/dof/depth_picture.h"

namespace relumbre {

struct SpreadConfig {
  BlurShape shape = BlurShape::kAperture;
  Aperture aperture = {};
  std::size_t layers = 24;        ///< steps of the circle of confusion that are told apart
  double largest_diameter = 512;  ///< pixels; what is blurred more is blurred as much
};

/// Every pixel of the picture, and of what lies behind it, spreads its colour over its circle of
/// confusion: steps up and down are written where rows of the blur begin and end, and one running
/// sum fills it. Layers from front to back then cover one another: each takes what share of a pixel
/// the layers before it have left over. So a blurred foreground is soft and what it uncovers is
/// seen, nothing sharp bleeds into what lies behind it, and what is in focus stays as it is.
///
/// The box takes 16 steps a pixel and two running sums, whatever its size; others take four steps a
/// row of the blur. Beyond its border the picture goes on as it ends. Colours come back
/// premultiplied; results do not depend on the number of threads.
/// Source: Kosloff, Tao and Barsky 2009 (spreading by summed-area tables in reverse).
std::vector<Rgba> spread(const DepthPicture& picture, const ThinLens& lens,
                         const SpreadConfig& config = {}, Progress& progress = no_progress());

}  // namespace relumbre
