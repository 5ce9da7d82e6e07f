#include "relumbre/dof/surface_edges.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

/// A jump is the same from both sides, so that four of eight neighbours are enough.
struct Step {
  int dx, dy;
};
constexpr Step kForward[] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};

}  // namespace

float SurfaceEdges::expected(std::ptrdiff_t x, std::ptrdiff_t y, int dx, int dy) const {
  const float one = at(x - dx, y - dy);
  if (!inside(x - 2 * dx, y - 2 * dy)) return one;
  return 2 * one - at(x - 2 * dx, y - 2 * dy);
}

bool SurfaceEdges::find_jump(std::ptrdiff_t x, std::ptrdiff_t y, int dx, int dy) const {
  if (!inside(x + dx, y + dy)) return false;
  const float here = at(x, y), there = at(x + dx, y + dy);
  if (std::abs(here - there) <= kOneSurface) return false;
  return std::abs(there - expected(x + dx, y + dy, dx, dy)) > kOneSurface &&
         std::abs(here - expected(x, y, -dx, -dy)) > kOneSurface;
}

SurfaceEdges::SurfaceEdges(std::span<const float> circles, std::size_t width, std::size_t height)
    : circles_(circles),
      width_(static_cast<std::ptrdiff_t>(width)),
      height_(static_cast<std::ptrdiff_t>(height)),
      jumps_(circles.size()) {
  parallel_for(0, jumps_.size(), 1 << 14, [&](std::size_t i) {
    const auto x = static_cast<std::ptrdiff_t>(i % width),
               y = static_cast<std::ptrdiff_t>(i / width);
    unsigned jumps = 0;
    for (unsigned bit = 0; bit < std::size(kForward); ++bit)
      if (find_jump(x, y, kForward[bit].dx, kForward[bit].dy)) jumps |= 1U << bit;
    jumps_[i] = static_cast<std::uint8_t>(jumps);
  });
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
