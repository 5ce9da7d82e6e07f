/// What a table must know of an image before it is built, where the caller does not.
#pragma once

#include <array>
#include <span>

#include "relumbre/sat/fixed_point.h"
#include "relumbre/sat/sat_layout.h"

namespace relumbre {

/// Smallest and largest value over all channels; 0 to 0 of no pixels. One read of the image. Throws
/// ValueError naming the first pixel that is not finite.
SatRange find_range(std::span<const float> pixels, const SatLayout& layout);

/// Of each channel, in double; the same bits whatever the number of threads. One read of the image.
/// Throws ValueError naming the first pixel that is not finite. In: float, uint8, uint16, uint32.
template <class In>
std::array<float, kSatMaxChannels> find_mean(std::span<const In> pixels, const SatLayout& layout);

/// Throws ValueError naming the first pixel with a value that is not finite or outside the range.
template <class In>
[[noreturn]] void report_outside(std::span<const In> pixels, const SatLayout& layout,
                                 const SatRange& range);

}  // namespace relumbre
