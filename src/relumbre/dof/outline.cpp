#include "relumbre/dof/outline.h"

#include <cmath>
#include <numbers>

namespace relumbre {

OutlineCorners outline_corners(BlurShape shape, const Aperture& aperture) {
  aperture.check();
  if (shape == BlurShape::kBox) {
    const double half = std::sqrt(std::numbers::pi) / 4;
    return {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  }
  const double turn = aperture.rotation_deg * std::numbers::pi / 180;
  OutlineCorners corners;
  for (int i = 0; i < aperture.blades; ++i) {
    const double angle = turn + 2 * std::numbers::pi * i / aperture.blades;
    corners.push_back({std::cos(angle) / 2, -std::sin(angle) / 2});
  }
  return corners;
}

}  // namespace relumbre
