#include "relumbre/dof/surface_edges.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/parallel.h"

namespace relumbre {

float SurfaceEdges::expected(std::ptrdiff_t x, std::ptrdiff_t y, int dx, int dy) const {
  const float one = at(x - dx, y - dy);
  if (!inside(x - 2 * dx, y - 2 * dy)) return one;
  return 2 * one - at(x - 2 * dx, y - 2 * dy);
}

bool SurfaceEdges::jump(std::size_t x, std::size_t y, int dx, int dy) const {
  const auto x0 = static_cast<std::ptrdiff_t>(x), y0 = static_cast<std::ptrdiff_t>(y);
  const std::ptrdiff_t x1 = x0 + dx, y1 = y0 + dy;
  if (!inside(x1, y1)) return false;
  const float here = at(x0, y0), there = at(x1, y1);
  if (std::abs(here - there) <= kOneSurface) return false;
  return std::abs(there - expected(x1, y1, dx, dy)) > kOneSurface &&
         std::abs(here - expected(x0, y0, -dx, -dy)) > kOneSurface;
}

float SurfaceEdges::slope_along(std::size_t x, std::size_t y, int dx, int dy) const {
  const auto x0 = static_cast<std::ptrdiff_t>(x), y0 = static_cast<std::ptrdiff_t>(y);
  const bool next = inside(x0 + dx, y0 + dy) && !jump(x, y, dx, dy);
  const bool last = inside(x0 - dx, y0 - dy) && !jump(x, y, -dx, -dy);
  const float here = at(x0, y0);
  const float after = next ? at(x0 + dx, y0 + dy) : here,
              before = last ? at(x0 - dx, y0 - dy) : here;
  return (after - before) / (next && last ? 2.0F : 1.0F);
}

Vec2f SurfaceEdges::slope(std::size_t x, std::size_t y) const {
  return {slope_along(x, y, 1, 0), slope_along(x, y, 0, 1)};
}

std::vector<std::uint8_t> SurfaceEdges::pixels() const {
  std::vector<std::uint8_t> result(circles_.size());
  const auto width = static_cast<std::size_t>(width_);
  parallel_for(0, static_cast<std::size_t>(height_), 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      bool any = false;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) any = any || ((dx != 0 || dy != 0) && jump(x, y, dx, dy));
      result[y * width + x] = any ? 1 : 0;
    }
  });
  return result;
}

}  // namespace relumbre
