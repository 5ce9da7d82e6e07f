/// How different two images are.
#pragma once

#include <cstdint>
#include <span>

#include "relumbre/image/image.h"
#include "relumbre/image/tone_map.h"

namespace relumbre {

// All of these take two images of one size with channels R, G and B. They throw ShapeError naming
// both sizes if these differ, ValueError if a channel is missing. A NaN in the images gives NaN.
//
// A mask (width · height, as silhouette_band() makes it) restricts a mean to the pixels where it is
// not 0; if there are none the mean is NaN. Without a mask all count. A mask of another size throws
// ShapeError.
using PixelMask = std::span<const std::uint8_t>;

/// Mean over pixels and R, G, B of the squared difference. Symmetric.
double mean_squared_error(const Image& a, const Image& b, PixelMask mask = {});

/// 10 log10(peak² / MSE) in dB, MSE over R, G and B together; infinite for equal images.
/// Throws ValueError unless peak > 0.
double psnr(const Image& a, const Image& b, double peak = 1, PixelMask mask = {});

enum class SsimOf {
  kLuminance,  ///< of the Rec. 709 weighted sum of R, G, B
  kRgbMean,    ///< of each of R, G, B, and then the mean of the three
};

/// Mean structural similarity in [-1, 1], 1 for equal images: 11 x 11 Gaussian windows of
/// sigma 1.5, K1 = 0.01, K2 = 0.03, over all windows that lie inside the image and whose middle the
/// mask holds. Throws ShapeError if a side is below 11, ValueError unless peak > 0. About 110 flops
/// a pixel and plane, 40 bytes a pixel. Source: Wang, Bovik, Sheikh and Simoncelli 2004.
double ssim(const Image& a, const Image& b, double peak = 1, SsimOf of = SsimOf::kLuminance,
            PixelMask mask = {});

struct ImageComparison {
  double mse = 0;
  double psnr_db = 0;
  double ssim_luminance = 0;  ///< NaN where a side is below 11
  double ssim_rgb = 0;        ///< NaN where a side is below 11
};

/// All of the above for images of peak 1 (display values).
ImageComparison compare_images(const Image& a, const Image& b, PixelMask mask = {});

/// Compares linear HDR images as a viewer sees them: both are exposed by the scale that `config`
/// gives for `reference`, tone mapped and sRGB-encoded to [0, 1], not rounded; then peak 1.
ImageComparison compare_tone_mapped(const Image& reference, const Image& test,
                                    const ToneConfig& config = {}, PixelMask mask = {});

/// |a - b| in R, G and B.
Image difference_image(const Image& a, const Image& b);

}  // namespace relumbre
