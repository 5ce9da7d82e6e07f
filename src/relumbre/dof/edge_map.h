/// Internal: what neighbouring pixels have to do with one another, for the CPU and the GPU.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "relumbre/base/host_device.h"
#include "relumbre/base/vec3.h"

namespace relumbre {

/// Circles of confusion that differ by less belong to one surface, pixels.
inline constexpr float kOneSurface = 1.5F;

/// Signed circles of confusion of width × height pixels, and where they jump. See SurfaceEdges.
struct CirclePlane {
  const float* circles = nullptr;
  std::ptrdiff_t width = 0, height = 0;

  [[nodiscard]] RELUMBRE_HOST_DEVICE bool inside(std::ptrdiff_t x, std::ptrdiff_t y) const {
    return x >= 0 && y >= 0 && x < width && y < height;
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE float at(std::ptrdiff_t x, std::ptrdiff_t y) const {
    return circles[y * width + x];
  }
  /// A jump is the same from both sides, so that four of eight neighbours are enough: bit 0 is the
  /// one to the right, bits 1 to 3 are those below from left to right.
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::uint8_t jumps_at(std::ptrdiff_t x,
                                                           std::ptrdiff_t y) const {
    unsigned jumps = find_jump(x, y, 1, 0) ? 1 : 0;
    for (int dx = -1; dx <= 1; ++dx)
      if (find_jump(x, y, dx, 1)) jumps |= 1U << (dx + 2);
    return static_cast<std::uint8_t>(jumps);
  }

 private:
  [[nodiscard]] RELUMBRE_HOST_DEVICE bool find_jump(std::ptrdiff_t x, std::ptrdiff_t y, int dx,
                                                    int dy) const {
    if (!inside(x + dx, y + dy)) return false;
    const float here = at(x, y), there = at(x + dx, y + dy);
    if (std::abs(here - there) <= kOneSurface) return false;
    return std::abs(there - expected(x + dx, y + dy, dx, dy)) > kOneSurface &&
           std::abs(here - expected(x, y, -dx, -dy)) > kOneSurface;
  }
  /// The circle at (x, y) as the two pixels before it, in direction (dx, dy), would have it.
  [[nodiscard]] RELUMBRE_HOST_DEVICE float expected(std::ptrdiff_t x, std::ptrdiff_t y, int dx,
                                                    int dy) const {
    const float one = at(x - dx, y - dy);
    if (!inside(x - 2 * dx, y - 2 * dy)) return one;
    return 2 * one - at(x - 2 * dx, y - 2 * dy);
  }
};

/// The same once the jumps are found.
struct EdgeMap {
  CirclePlane plane;
  const std::uint8_t* jumps = nullptr;  ///< jumps_at() of every pixel

  /// Between pixel (x, y) and its neighbour at (x + dx, y + dy). False where there is none.
  [[nodiscard]] RELUMBRE_HOST_DEVICE bool jump(std::ptrdiff_t x, std::ptrdiff_t y, int dx,
                                               int dy) const {
    if (dy < 0 || (dy == 0 && dx < 0)) x += dx, y += dy, dx = -dx, dy = -dy;
    if (!plane.inside(x, y)) return false;
    const int bit = dy == 0 ? 0 : dx + 2;
    return (jumps[y * plane.width + x] >> bit & 1) != 0;
  }
  /// By how much the circle grows from a pixel to the next, to the right and downwards, on the
  /// pixel's own surface.
  [[nodiscard]] RELUMBRE_HOST_DEVICE Vec2f slope(std::ptrdiff_t x, std::ptrdiff_t y) const {
    return {slope_along(x, y, 1, 0), slope_along(x, y, 0, 1)};
  }
  /// Beside a jump to any of its eight neighbours: its colour may be a mixture of both sides.
  [[nodiscard]] RELUMBRE_HOST_DEVICE bool beside_jump(std::ptrdiff_t x, std::ptrdiff_t y) const {
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if ((dx != 0 || dy != 0) && jump(x, y, dx, dy)) return true;
    return false;
  }

 private:
  [[nodiscard]] RELUMBRE_HOST_DEVICE float slope_along(std::ptrdiff_t x, std::ptrdiff_t y, int dx,
                                                       int dy) const {
    const bool next = plane.inside(x + dx, y + dy) && !jump(x, y, dx, dy);
    const bool last = plane.inside(x - dx, y - dy) && !jump(x, y, -dx, -dy);
    const float here = plane.at(x, y);
    const float after = next ? plane.at(x + dx, y + dy) : here,
                before = last ? plane.at(x - dx, y - dy) : here;
    return (after - before) / (next && last ? 2.0F : 1.0F);
  }
};

}  // namespace relumbre
