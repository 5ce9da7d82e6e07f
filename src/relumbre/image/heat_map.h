/// Numbers of pixels as colours.
#pragma once

#include <span>
#include <string>

#include "relumbre/image/image.h"

namespace relumbre {

/// From 0 to 1: dark blue, red, yellow, white.
Rgb heat_color(float v);

/// Paints R G B of an image by one of its other channels, relative to the channel's largest value,
/// or to 1 if that is less. Values are 0 or more.
void paint_heat(Image& image, const std::string& channel);

}  // namespace relumbre
