/// How a summed-area table lies in memory.
#pragma once

#include <cstddef>

#include "relumbre/base/host_device.h"

namespace relumbre {

inline constexpr std::size_t kSatMaxChannels = 4;
inline constexpr std::size_t kSatMaxSide = std::size_t{1} << 24;  ///< pixels of a side
inline constexpr std::size_t kSatMaxBytes = std::size_t{1} << 36;

/// Where each sum is. t(x, y) is the sum of all pixels left of x and above y, so x runs from 0 to
/// width and y from 0 to height, both inclusive, and row 0 and column 0 are zero: no query asks
/// whether it is at the edge. The first pixel's sums begin a cache line in every row:
///
///     │◄────────────────────────── row_stride ──────────────────────────►│
///     ├── a cache line ───┬──────── whole cache lines ───────────────────┤
///     │ unused   t(0,0)=0 │ t(1,0)=0   t(2,0)=0  …  t(w,0)=0 │ unused     │  y = 0
///     │ unused   t(0,1)=0 │ t(1,1)     t(2,1)    …  t(w,1)   │ unused     │  y = 1
///     │    …              │    …                             │            │
///     │ unused   t(0,h)=0 │ t(1,h)     t(2,h)    …  t(w,h)   │ unused     │  y = h
///
/// Channels are interleaved: t(x, y) is `channels` neighbours.
struct SatLayout {
  std::size_t width = 0, height = 0;  ///< of the image
  std::size_t channels = 1;
  std::size_t origin = 0;      ///< index of t(0, 0), in elements
  std::size_t row_stride = 0;  ///< in elements
  std::size_t elements = 0;    ///< of the whole table

  [[nodiscard]] RELUMBRE_HOST_DEVICE std::size_t at(std::size_t x, std::size_t y) const {
    return origin + y * row_stride + x * channels;
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::size_t pixels() const { return width * height; }
};

/// The layout of a table whose sums are `element_bytes` (4 or 8) long. Either side may be 0. Throws
/// ShapeError: 0 or more than 4 channels, a side above 2^24, a table above 2^36 bytes.
SatLayout make_sat_layout(std::size_t width, std::size_t height, std::size_t channels,
                          std::size_t element_bytes);

/// Throws ShapeError unless `values` is what an image of this size has.
void check_pixel_count(const SatLayout& layout, std::size_t values);

}  // namespace relumbre
