/// Internal: boxes of premultiplied colours.
#pragma once

#include <span>
#include <vector>

#include "relumbre/dof/depth_picture.h"
#include "relumbre/sat/box_filter.h"

namespace relumbre {

static_assert(sizeof(Rgba) == 4 * sizeof(float));

inline std::span<float> flat(std::vector<Rgba>& colors) {
  return {&colors.front().r, 4 * colors.size()};
}
inline std::span<const float> flat(const std::vector<Rgba>& colors) {
  return {&colors.front().r, 4 * colors.size()};
}

/// In doubles: pictures with lamps in them have a range that no fixed point holds.
inline SummedAreaTable rgba_table(const std::vector<Rgba>& colors, std::size_t width,
                                  std::size_t height) {
  return SummedAreaTable::build(flat(colors), width, height, 4, {.kind = SatKind::kFloat64});
}

}  // namespace relumbre
