/// The sRGB transfer function, exact and piecewise.
/// Source: IEC 61966-2-1:1999, with Rec. 709 primaries.
#pragma once

#include <cmath>
#include <cstdint>

namespace relumbre {

/// Linear [0, 1] to encoded [0, 1]. Values outside are extended by the same formulas.
inline float srgb_encode(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F;
}

/// Encoded [0, 1] to linear [0, 1]: the inverse of srgb_encode.
inline float srgb_decode(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

/// [0, 1] to the nearest of 256 levels; what lies outside is clamped, NaN becomes 0.
inline std::uint8_t to_byte(float value) {
  if (!(value > 0)) return 0;
  return value >= 1 ? std::uint8_t{255} : static_cast<std::uint8_t>(std::lround(value * 255.0F));
}

}  // namespace relumbre
