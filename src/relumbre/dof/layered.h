/// Depth of field by layers: one blur for everything of about one depth.
#pragma once

#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

struct LayeredConfig {
  std::size_t layers = 64;        ///< steps of the circle of confusion
  double largest_diameter = 512;  ///< pixels
};

/// The picture, and what lies behind it, is cut into layers by its signed circle of confusion. Each
/// layer's premultiplied colour and coverage are blurred by a box with the area of the layer's mean
/// circle of confusion, by summed-area tables. From front to back, each layer takes what share of a
/// pixel the layers before it have left over: the coverages of a surface that crosses from one
/// layer into the next add up to 1. What is blurred alike within a layer steps to the next one's
/// blur at its border. Time and memory do not depend on the blur. Throws as spread().
std::vector<Rgba> layered(const DepthPicture& picture, const ThinLens& lens,
                          const LayeredConfig& config = {}, Progress& progress = no_progress());

}  // namespace relumbre
