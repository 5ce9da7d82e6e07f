/// A voxel's colour as other programs show it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "relumbre/image/srgb.h"
#include "relumbre/octree/voxel_value.h"

namespace relumbre {

/// 8-bit sRGB, clamped, of the mean of both sides' linear colours times `exposure`.
inline std::array<std::uint8_t, 3> display_color(const VoxelValue& value, float exposure) {
  const Rgb linear = (unpack_color(value.color) + back_color(value)) * (exposure / 2);
  std::array<std::uint8_t, 3> srgb;
  for (std::size_t c = 0; c < 3; ++c) {
    const float encoded = srgb_encode(std::fmin(linear[c], 1.0F));
    srgb[c] = static_cast<std::uint8_t>(std::lround(255 * encoded));
  }
  return srgb;
}

}  // namespace relumbre
