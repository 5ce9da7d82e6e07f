#include "relumbre/dof/blur_steps.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

/// Side of the box that has the area of a disc of diameter 1: √π / 2.
constexpr float kBoxSide = 0.8862269F;
/// Up to about this diameter steps are even, beyond they grow with it.
constexpr float kEven = 8;

/// The nearest whose box has a whole radius.
float with_whole_radius(float diameter) {
  const float radius = std::round(box_radius_of(diameter));
  return radius == 0 ? 0 : std::copysign((2 * radius + 1) / kBoxSide, diameter);
}

}  // namespace

float box_radius_of(float signed_diameter) { return box_radius(kBoxSide * signed_diameter); }

std::vector<float> blur_steps(float least, float largest, std::size_t steps) {
  if (steps == 0) throw ValueError("layers: 0 asked, at least 1 is needed");
  const float first = std::asinh(least / kEven), last = std::asinh(largest / kEven);
  std::vector<float> result{least, largest};
  const auto add = [&](float diameter) {
    if (diameter > least && diameter < largest) result.push_back(diameter);
  };
  add(0);
  for (std::size_t i = 1; i < steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    add(with_whole_radius(kEven * std::sinh(first + t * (last - first))));
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace relumbre
