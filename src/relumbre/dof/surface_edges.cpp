#include "relumbre/dof/surface_edges.h"

#include "relumbre/base/parallel.h"

namespace relumbre {

SurfaceEdges::SurfaceEdges(std::span<const float> circles, std::size_t width, std::size_t height)
    : plane_{circles.data(), static_cast<std::ptrdiff_t>(width),
             static_cast<std::ptrdiff_t>(height)},
      jumps_(circles.size()) {
  parallel_for(0, jumps_.size(), 1 << 14, [&](std::size_t i) {
    jumps_[i] = plane_.jumps_at(static_cast<std::ptrdiff_t>(i % width),
                                static_cast<std::ptrdiff_t>(i / width));
  });
}

std::vector<std::uint8_t> SurfaceEdges::pixels() const {
  std::vector<std::uint8_t> result(jumps_.size());
  const EdgeMap edges = map();
  const auto width = static_cast<std::size_t>(plane_.width);
  parallel_for(0, static_cast<std::size_t>(plane_.height), 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      result[y * width + x] =
          edges.beside_jump(static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(y)) ? 1 : 0;
    }
  });
  return result;
}

}  // namespace relumbre
