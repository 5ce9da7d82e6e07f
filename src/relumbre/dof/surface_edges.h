/// Where one surface of a picture ends and another begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// Circles of confusion that differ by less belong to one surface, pixels.
inline constexpr float kOneSurface = 1.5F;

/// Finds jumps between neighbouring pixels in their signed circles of confusion. These are linear
/// in inverse depth, so on a plane they change evenly from pixel to pixel however it is inclined:
/// a step that goes on as the pixels on either side of it do is no jump.
class SurfaceEdges {
 public:
  /// `circles`: width × height, or empty; outlives this. O(pixels).
  SurfaceEdges(std::span<const float> circles, std::size_t width, std::size_t height);

  /// Between pixel (x, y) and its neighbour at (x + dx, y + dy). False where there is none.
  [[nodiscard]] bool jump(std::size_t x, std::size_t y, int dx, int dy) const {
    auto u = static_cast<std::ptrdiff_t>(x), v = static_cast<std::ptrdiff_t>(y);
    if (dy < 0 || (dy == 0 && dx < 0)) u += dx, v += dy, dx = -dx, dy = -dy;
    if (!inside(u, v)) return false;
    const int bit = dy == 0 ? 0 : dx + 2;
    return (jumps_[static_cast<std::size_t>(v * width_ + u)] >> bit & 1) != 0;
  }
  /// By how much the circle grows from a pixel to the next, to the right and downwards, on the
  /// pixel's own surface.
  [[nodiscard]] Vec2f slope(std::size_t x, std::size_t y) const;
  /// 1 for pixels beside a jump to any of their eight neighbours: their colours may be mixtures of
  /// both sides. O(pixels).
  [[nodiscard]] std::vector<std::uint8_t> pixels() const;

 private:
  [[nodiscard]] bool inside(std::ptrdiff_t x, std::ptrdiff_t y) const {
    return x >= 0 && y >= 0 && x < width_ && y < height_;
  }
  [[nodiscard]] float at(std::ptrdiff_t x, std::ptrdiff_t y) const {
    return circles_[static_cast<std::size_t>(y * width_ + x)];
  }
  [[nodiscard]] bool find_jump(std::ptrdiff_t x, std::ptrdiff_t y, int dx, int dy) const;
  [[nodiscard]] float slope_along(std::size_t x, std::size_t y, int dx, int dy) const;
  /// The circle at (x, y) as the two pixels before it, in direction (dx, dy), would have it.
  [[nodiscard]] float expected(std::ptrdiff_t x, std::ptrdiff_t y, int dx, int dy) const;

  std::span<const float> circles_;
  std::ptrdiff_t width_, height_;
  std::vector<std::uint8_t> jumps_;  // a bit for each of half of a pixel's neighbours
};

}  // namespace relumbre
