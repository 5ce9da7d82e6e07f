/// Pixels in which two surfaces meet.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "relumbre/dof/depth_picture.h"
#include "relumbre/dof/surface_edges.h"
#include "relumbre/dof/unmix.h"

namespace relumbre {

/// A picture with smooth edges has one depth for a pixel that shows two surfaces. Where the circle
/// of confusion jumps, what unmixed pixels around show of the nearer and of the farther surface
/// says how much of each a pixel has; the rest of its colour is added to both, so that the mixture
/// is the pixel's colour exactly. A pixel twice as bright as either, of a lamp too thin to have
/// pixels of its own, is left whole with the sharper of the two.
class Unmixer {
 public:
  /// `front`: signed circles of confusion of picture.front, `edges` theirs. The first two outlive
  /// this. O(pixels).
  Unmixer(const DepthPicture& picture, std::span<const float> front, const SurfaceEdges& edges);

  /// Nothing where there is no jump between the pixel and one beside it.
  [[nodiscard]] std::optional<MixedPixel> operator()(std::size_t x, std::size_t y) const;
  /// What unmix() reads; as long as this lives.
  [[nodiscard]] MixedPicture plain() const {
    return {picture_.front.color.data(), front_.data(), mixed_.data(), picture_.width,
            picture_.height};
  }

 private:
  const DepthPicture& picture_;
  std::span<const float> front_;
  std::vector<std::uint8_t> mixed_;
};

}  // namespace relumbre
