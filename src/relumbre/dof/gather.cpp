#include "relumbre/dof/gather.h"

#include <cmath>

#include "relumbre/dof/blur_steps.h"
#include "relumbre/dof/box_blur.h"
#include "relumbre/dof/focus.h"

namespace relumbre {

std::vector<Rgba> gather(const DepthPicture& picture, const ThinLens& lens,
                         double largest_diameter) {
  picture.check();
  std::vector<float> radii =
      circles_of_confusion(picture.front.depth, lens, picture.width, largest_diameter);
  for (float& circle : radii) circle = box_radius(circle);
  const SummedAreaTable table = rgba_table(picture.front.color, picture.width, picture.height);
  std::vector<Rgba> result(picture.pixels());
  box_filter(table, radii, {.mode = Border::kClamp}, flat(result));
  return result;
}

}  // namespace relumbre
