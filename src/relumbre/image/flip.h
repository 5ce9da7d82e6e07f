/// FLIP: the difference that a person sees when two images are shown in turns at one place.
///
///   reference ─► YCxCz ─► contrast sensitivity filters ─► Hunt-adjusted L*a*b* ─┐
///   test ──────► YCxCz ─► ....................................................─ HyAB ─► ΔEc ──┐
///                  │                                                                          ▼
///                  └────► edge and point detectors ─► difference of strengths ─► ΔEf ─►
///                  ΔEc^(1−ΔEf)
///
/// Sources: Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images" (LDR), and
/// Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images" (HDR).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/image/image.h"

namespace relumbre {

/// Pixels that a degree of visual angle covers in the middle of a screen. The papers' screen is
/// 0.7 m wide with 3840 pixels, seen from 0.7 m: 67.02. Throws ValueError unless all are above 0.
double pixels_per_degree(double distance_m = 0.7, double width_m = 0.7, double width_px = 3840);

struct FlipConfig {
  double pixels_per_degree = 67.02064327658226;
};

// Both take two images of one size with channels R, G and B, and give an error in [0, 1] a pixel,
// row 0 at the top; the error is the same if reference and test are swapped, but for the exposures
// that flip_hdr chooses. Beyond the border the nearest pixel counts. They throw ShapeError naming
// both sizes if these differ, ValueError if a channel is missing or the pixels per degree are not
// between 1 and 1000. A NaN in the images gives NaN around it. About 600 flops a pixel at the
// default, 60 bytes a pixel.

/// Of display values: sRGB-encoded, clamped to [0, 1].
std::vector<float> flip_ldr(const Image& reference, const Image& test,
                            const FlipConfig& config = {});

/// The range of exposures, in stops, over which an image is looked at.
struct ExposureRange {
  double start = 0, stop = 0;
  std::size_t count = 2;
};

/// From the exposure at which the brightest pixel, to that at which the median one, is shown at
/// 0.85 of white; a step is at most one stop, and there are at least two. Only finite luminances
/// count, and where more than half of these are 0, the median is of the others. {0, 0, 2} where all
/// are 0. Throws ValueError if a channel is missing. Andersson et al. 2021, §3.
ExposureRange flip_exposures(const Image& reference);

struct HdrFlip {
  std::vector<float> error;
  ExposureRange exposures;
};

/// Of linear values, negative ones taken as 0: at every exposure that flip_exposures(reference)
/// names both images are tone mapped (the papers' ACES fit) and compared by flip_ldr; the largest
/// of the errors counts. Costs that many times flip_ldr.
HdrFlip flip_hdr(const Image& reference, const Image& test, const FlipConfig& config = {});

/// Mean of the errors, or of those where `mask` is not 0; NaN where none counts. Throws ShapeError
/// if there is a mask of another size.
double mean_error(std::span<const float> error, std::span<const std::uint8_t> mask = {});

/// Errors as 8-bit sRGB, from black (0) through magenta to pale yellow (1): width · height · 3, for
/// write_png. Source: the colour map "magma" of Smith and van der Walt 2015.
std::vector<std::uint8_t> error_picture(std::span<const float> error);

}  // namespace relumbre
