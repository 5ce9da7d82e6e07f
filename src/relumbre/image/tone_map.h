/// From linear radiance to what a screen shows.
#pragma once

#include <cstdint>
#include <vector>

#include "relumbre/image/image.h"
#include "relumbre/image/srgb.h"

namespace relumbre {

enum class ToneCurve {
  kFilmic,  ///< a shoulder that keeps highlights. Source: Narkowicz 2015, ACES filmic fit
  kSrgb,    ///< linear up to 1, then clipped
};

struct ToneConfig {
  float exposure_stops = 0;  ///< radiance is multiplied by 2^stops, on top of auto exposure
  bool auto_exposure = false;
  ToneCurve curve = ToneCurve::kFilmic;
};

/// Stops that bring the image's log-average luminance to a key of 0.18 (Reinhard et al. 2002,
/// §3.1). Only finite, positive luminances count, and of these the darkest and the brightest 5% do
/// not, so that lamps in view and black background do not decide. 0 where no pixel counts. Throws
/// ValueError if R, G or B is missing. O(pixels), 4 bytes a pixel.
float auto_exposure_stops(const Image& image);

/// What radiance is multiplied by: 2^(exposure + auto exposure of `image` if asked).
/// Throws ValueError if the exposure is not a number, or R, G or B is missing.
float exposure_scale(const Image& image, const ToneConfig& config);

/// Exposed linear RGB to display values in [0, 1], sRGB-encoded. NaN and negative become 0.
Rgb display_color(const Rgb& exposed, ToneCurve curve);

/// R, G, B in [0, 1], sRGB-encoded: the picture before it is rounded to bytes.
Image tone_mapped(const Image& image, const ToneConfig& config = {});

/// 8-bit sRGB, width · height · 3, row 0 at the top: what write_png takes.
std::vector<std::uint8_t> tone_map(const Image& image, const ToneConfig& config = {});

}  // namespace relumbre
