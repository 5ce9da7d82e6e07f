#include "relumbre/sat/sat_layout.h"

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/sat/sat_kernels.h"

namespace relumbre {

namespace {

constexpr std::size_t kCacheLine = 64;

}  // namespace

SatLayout make_sat_layout(std::size_t width, std::size_t height, std::size_t channels,
                          std::size_t element_bytes) {
  const auto refuse = [&](std::string_view reason) {
    throw ShapeError(fmt::format("summed-area table of {} x {} pixels of {} channels: {}", width,
                                 height, channels, reason));
  };
  if (channels < 1 || channels > kSatMaxChannels) refuse("channels must be 1 to 4");
  if (width > kSatMaxSide || height > kSatMaxSide) refuse("a side is above 2^24");
  const std::size_t line = kCacheLine / element_bytes;
  const std::size_t row = line + (width + kSatGroup - 1) / kSatGroup * kSatGroup * channels;
  // The factors are below 2^30 and 2^25, so the product cannot overflow.
  if (row * element_bytes * (height + 1) > kSatMaxBytes) refuse("the table is above 2^36 bytes");
  return {width, height, channels, line - channels, row, row * (height + 1)};
}

void check_pixel_count(const SatLayout& layout, std::size_t values) {
  const std::size_t expected = layout.pixels() * layout.channels;
  if (values == expected) return;
  throw ShapeError(fmt::format("an image of {} x {} pixels of {} channels has {} values, not {}",
                               layout.width, layout.height, layout.channels, expected, values));
}

}  // namespace relumbre
