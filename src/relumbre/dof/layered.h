/// Depth of field by layers: one blur for everything of about one depth.
#pragma once

#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

struct LayeredConfig {
  std::size_t layers = 24;        ///< steps of the circle of confusion
  double largest_diameter = 512;  ///< pixels
};

/// The picture, and what lies behind it, is cut into layers by its signed circle of confusion. Each
/// layer's premultiplied colour and alpha are blurred by a box of the layer's mean circle of
/// confusion, by a summed-area table, and the layers are composited from back to front. A surface
/// that crosses from one layer into the next is a little transparent there. Time and memory do not
/// depend on the blur. Throws as spread().
std::vector<Rgba> layered(const DepthPicture& picture, const ThinLens& lens,
                          const LayeredConfig& config = {}, Progress& progress = no_progress());

}  // namespace relumbre
