/// Where one surface of a picture ends and another begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/dof/edge_map.h"

namespace relumbre {

/// Finds jumps between neighbouring pixels in their signed circles of confusion. These are linear
/// in inverse depth, so on a plane they change evenly from pixel to pixel however it is inclined:
/// a step that goes on as the pixels on either side of it do is no jump.
class SurfaceEdges {
 public:
  /// `circles`: width × height, or empty; outlives this. O(pixels).
  SurfaceEdges(std::span<const float> circles, std::size_t width, std::size_t height);

  /// Between pixel (x, y) and its neighbour at (x + dx, y + dy). False where there is none.
  [[nodiscard]] bool jump(std::size_t x, std::size_t y, int dx, int dy) const {
    return map().jump(static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(y), dx, dy);
  }
  /// By how much the circle grows from a pixel to the next, to the right and downwards, on the
  /// pixel's own surface.
  [[nodiscard]] Vec2f slope(std::size_t x, std::size_t y) const {
    return map().slope(static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(y));
  }
  /// 1 for pixels beside a jump to any of their eight neighbours: their colours may be mixtures of
  /// both sides. O(pixels).
  [[nodiscard]] std::vector<std::uint8_t> pixels() const;
  /// What it has found; as long as it lives.
  [[nodiscard]] EdgeMap map() const { return {plane_, jumps_.data()}; }

 private:
  CirclePlane plane_;
  std::vector<std::uint8_t> jumps_;
};

}  // namespace relumbre
