/// Internal: what a pixel of the front is made of, for the CPU and the GPU.
#pragma once

#include <cstdint>

#include "relumbre/base/host_device.h"
#include "relumbre/base/vec3.h"
#include "relumbre/dof/unmix.h"

namespace relumbre {

/// A pixel's worth of a surface, or a share of it.
struct Fragment {
  std::uint32_t x = 0, y = 0;
  float coc = 0;       ///< signed diameter of its circle of confusion, pixels
  Vec2f slope;         ///< by which that grows from pixel to pixel, to the right and downwards
  float coverage = 1;  ///< of the pixel
  Rgba color;          ///< multiplied by the coverage
};

/// Calls use(fragment) for those of a pixel of the front, one or two, the nearer first.
template <class Use>
RELUMBRE_HOST_DEVICE void front_fragments(const MixedPicture& picture, const EdgeMap& edges,
                                          std::uint32_t x, std::uint32_t y, Use&& use) {
  const std::size_t i = y * picture.width + x;
  if (picture.mixed[i] == 0) {
    use(Fragment{x, y, picture.circles[i], edges.slope(x, y), 1, picture.color[i]});
    return;
  }
  const MixedPixel mixed = unmix(picture, x, y);
  const float share = mixed.share, rest = 1 - share;
  const auto scaled = [](const Rgba& c, float s) {
    return Rgba{c.r * s, c.g * s, c.b * s, c.a * s};
  };
  if (share > 0) use(Fragment{x, y, mixed.near_coc, {}, share, scaled(mixed.near, share)});
  if (rest > 0) use(Fragment{x, y, mixed.far_coc, {}, rest, scaled(mixed.far, rest)});
}

}  // namespace relumbre
