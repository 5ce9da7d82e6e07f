/// Where the lens is focused, and how far everything is out of focus.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "relumbre/dof/depth_picture.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

/// A depth worth looking at: the median of the middle of the picture, weighted by a Gaussian of a
/// sixth of the height, of pixels where there is something. Throws ValueError if there is nothing.
/// For the depth at a pixel see focus_on_pixel() in thin_lens.h.
double automatic_focus(const DepthPicture& picture);

/// Signed diameter of the circle of confusion of every depth, in pixels of a picture `width` wide,
/// no larger than `largest` either way. Negative before the plane in focus. 0 of a depth of 0.
/// Throws ValueError for a largest blur below 0 or NaN, and what ThinLens::check() throws.
std::vector<float> circles_of_confusion(std::span<const float> depth, const ThinLens& lens,
                                        std::size_t width, double largest);

/// What is in focus in grey, what lies before it in red, behind it in blue; brighter with more
/// blur.
Image focus_overlay(const DepthPicture& picture, const ThinLens& lens);

}  // namespace relumbre
