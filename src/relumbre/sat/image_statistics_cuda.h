/// What a table must know of an image before it is built, where the caller does not: the twin of
/// image_statistics.h. Images are in device memory; both wait.
#pragma once

#include <array>
#include <cstddef>

#include "relumbre/cuda/stream.h"
#include "relumbre/sat/fixed_point.h"
#include "relumbre/sat/sat_layout.h"

namespace relumbre::cuda {

/// Smallest and largest value over all channels; 0 to 0 of no pixels. Throws ValueError naming the
/// first pixel that is not finite.
SatRange find_range(const float* pixels, const SatLayout& layout, const Stream& stream);

/// Of each channel, in double; the same bits in every run. In: float, uint8, uint16, uint32. What
/// is not finite makes the mean so.
template <class In>
std::array<float, kSatMaxChannels> find_mean(const In* pixels, const SatLayout& layout,
                                             const Stream& stream);

/// "(x, y) channel c" of a value of the image.
[[noreturn]] void throw_outside(std::size_t value, const SatLayout& layout, const SatRange& range);

}  // namespace relumbre::cuda
