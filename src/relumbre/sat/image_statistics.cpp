#include "relumbre/sat/image_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

/// Values, or pixels, of a chunk.
constexpr std::size_t kGrain = std::size_t{1} << 15;
/// As many running results side by side become vectors. A multiple of 1, 2, 3 and 4 channels.
constexpr std::size_t kLanes = 48;
constexpr SatRange kReals = {std::numeric_limits<float>::lowest(),
                             std::numeric_limits<float>::max()};

struct Extremes {
  float lowest = std::numeric_limits<float>::max(), highest = std::numeric_limits<float>::lowest();
  float zero = 0;  ///< NaN if a value was not finite
};

void take(float v, Extremes& e) {
  e.lowest = v < e.lowest ? v : e.lowest;
  e.highest = v > e.highest ? v : e.highest;
  e.zero += v * 0.0F;
}

Extremes extremes(std::span<const float> values) {
  Extremes all;
  std::array<float, kLanes> lowest, highest, zero{};
  lowest.fill(all.lowest), highest.fill(all.highest);
  std::size_t i = 0;
  for (; i + kLanes <= values.size(); i += kLanes) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const float v = values[i + l];
      lowest[l] = v < lowest[l] ? v : lowest[l];
      highest[l] = v > highest[l] ? v : highest[l];
      zero[l] += v * 0.0F;
    }
  }
  for (; i < values.size(); ++i) take(values[i], all);
  for (std::size_t l = 0; l < kLanes; ++l) {
    all.lowest = std::min(all.lowest, lowest[l]), all.highest = std::max(all.highest, highest[l]);
    all.zero += zero[l];
  }
  return all;
}

using Sums = std::array<double, kSatMaxChannels>;

/// Of pixels, the first of which begins with channel 0.
template <class In>
Sums sums_of(std::span<const In> values, std::size_t channels) {
  std::array<double, kLanes> lanes{};
  std::size_t i = 0;
  for (; i + kLanes <= values.size(); i += kLanes) {
    for (std::size_t l = 0; l < kLanes; ++l) lanes[l] += static_cast<double>(values[i + l]);
  }
  for (std::size_t l = 0; i + l < values.size(); ++l)
    lanes[l] += static_cast<double>(values[i + l]);
  Sums sums{};
  for (std::size_t l = 0; l < kLanes; ++l) sums[l % channels] += lanes[l];
  return sums;
}

}  // namespace

SatRange find_range(std::span<const float> pixels, const SatLayout& layout) {
  if (pixels.empty()) return {0, 0};
  std::vector<Extremes> parts((pixels.size() - 1) / kGrain + 1);
  parallel_chunks(0, pixels.size(), kGrain, [&](std::size_t first, std::size_t last) {
    parts[first / kGrain] = extremes(pixels.subspan(first, last - first));
  });
  Extremes all;
  for (const Extremes& e : parts) {
    all.lowest = std::min(all.lowest, e.lowest), all.highest = std::max(all.highest, e.highest);
    if (!(e.zero == 0)) report_outside(pixels, layout, kReals);
  }
  return {all.lowest, all.highest};
}

template <class In>
std::array<float, kSatMaxChannels> find_mean(std::span<const In> pixels, const SatLayout& layout) {
  std::array<float, kSatMaxChannels> mean{};
  const std::size_t count = layout.pixels(), channels = layout.channels;
  if (count == 0) return mean;
  std::vector<Sums> parts((count - 1) / kGrain + 1);
  parallel_chunks(0, count, kGrain, [&](std::size_t first, std::size_t last) {
    parts[first / kGrain] =
        sums_of(pixels.subspan(first * channels, (last - first) * channels), channels);
  });
  for (std::size_t c = 0; c < channels; ++c) {
    double sum = 0;
    for (const Sums& part : parts) sum += part[c];
    if (!std::isfinite(sum)) report_outside(pixels, layout, kReals);
    mean[c] = static_cast<float>(sum / static_cast<double>(count));
  }
  return mean;
}

template <class In>
void report_outside(std::span<const In> pixels, const SatLayout& layout, const SatRange& range) {
  const auto outside = [&](In v) {
    return !(static_cast<double>(v) >= range.lowest && static_cast<double>(v) <= range.highest);
  };
  const auto found = std::find_if(pixels.begin(), pixels.end(), outside);
  if (found == pixels.end())
    throw ValueError("summed-area table: the image changed while it was read");
  const auto at = static_cast<std::size_t>(found - pixels.begin());
  const std::size_t pixel = at / layout.channels;
  throw ValueError(fmt::format(
      "summed-area table: pixel ({}, {}) channel {} is {}, not from {} to {}", pixel % layout.width,
      pixel / layout.width, at % layout.channels, *found, range.lowest, range.highest));
}

template std::array<float, kSatMaxChannels> find_mean(std::span<const float>, const SatLayout&);
template std::array<float, kSatMaxChannels> find_mean(std::span<const std::uint8_t>,
                                                      const SatLayout&);
template std::array<float, kSatMaxChannels> find_mean(std::span<const std::uint16_t>,
                                                      const SatLayout&);
template std::array<float, kSatMaxChannels> find_mean(std::span<const std::uint32_t>,
                                                      const SatLayout&);
template void report_outside(std::span<const float>, const SatLayout&, const SatRange&);
template void report_outside(std::span<const std::uint8_t>, const SatLayout&, const SatRange&);
template void report_outside(std::span<const std::uint16_t>, const SatLayout&, const SatRange&);
template void report_outside(std::span<const std::uint32_t>, const SatLayout&, const SatRange&);

}  // namespace relumbre
