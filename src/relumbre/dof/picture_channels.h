/// Internal: which of an image's channels are the colour and the depth.
#pragma once

#include <string>

#include "relumbre/dof/depth_picture.h"

namespace relumbre {

/// What is before R, G, B and perhaps A.
bool has_color(const Image& image, const std::string& prefix);

struct PictureChannels {
  std::string color;  ///< prefix
  std::string depth;  ///< channel
};

/// As DepthPictureConfig says. Throws ValueError naming what is missing or ambiguous.
PictureChannels find_channels(const Image& image, const DepthPictureConfig& config);

}  // namespace relumbre
