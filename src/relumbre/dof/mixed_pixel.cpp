#include "relumbre/dof/mixed_pixel.h"

namespace relumbre {

Unmixer::Unmixer(const DepthPicture& picture, std::span<const float> front,
                 const SurfaceEdges& edges)
    : picture_(picture), front_(front), mixed_(edges.pixels()) {}

std::optional<MixedPixel> Unmixer::operator()(std::size_t x, std::size_t y) const {
  if (mixed_[y * picture_.width + x] == 0) return std::nullopt;
  return unmix(plain(), x, y);
}

}  // namespace relumbre
