/// Depth of field by layers: one blur for everything of about one depth.
#pragma once

#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

struct LayeredConfig {
  std::size_t layers = 64;        ///< steps of the circle of confusion, at most
  double largest_diameter = 512;  ///< pixels
};

/// The picture, and what lies behind it, is cut into steps of the signed circle of confusion (see
/// blur_steps.h). What lies between two steps is shared out between both in proportion, so that the
/// shares of a surface that crosses them add up to 1 and its blur changes evenly. Each step's
/// premultiplied colour and coverage are blurred by a box with the area of its circle of confusion,
/// by summed-area tables of that part of the picture where it has anything. From front to back,
/// each takes what share of a pixel those before it have left over. Time and memory hardly depend
/// on the blur. Throws as spread().
std::vector<Rgba> layered(const DepthPicture& picture, const ThinLens& lens,
                          const LayeredConfig& config = {}, Progress& progress = no_progress());

}  // namespace relumbre
