#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/warp.cuh"
#include "relumbre/sat/image_statistics_cuda.h"

namespace relumbre::cuda {

namespace {

/// Each warp has a part of the image and leaves one result, which the host puts together in order.
constexpr unsigned kThreads = 256, kWarps = kThreads / kWarp;
constexpr std::size_t kPart = std::size_t{1} << 12;  ///< pixels
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Extremes {
  float lowest = std::numeric_limits<float>::max(), highest = std::numeric_limits<float>::lowest();
  std::size_t first_not_finite = kNone;
};
struct Wider {
  __device__ Extremes operator()(const Extremes& a, const Extremes& b) const {
    return {b.lowest < a.lowest ? b.lowest : a.lowest,
            b.highest > a.highest ? b.highest : a.highest,
            b.first_not_finite < a.first_not_finite ? b.first_not_finite : a.first_not_finite};
  }
};

struct Sums {
  double of[kSatMaxChannels] = {};
};
struct Add {
  __device__ Sums operator()(const Sums& a, const Sums& b) const {
    Sums sums;
    for (unsigned c = 0; c < kSatMaxChannels; ++c) sums.of[c] = a.of[c] + b.of[c];
    return sums;
  }
};

__device__ std::size_t part_of_warp() {
  return std::size_t{blockIdx.x} * kWarps + threadIdx.x / kWarp;
}

__global__ void find_extremes(const float* values, std::size_t count, std::size_t part,
                              Extremes* results) {
  const unsigned lane = threadIdx.x % kWarp;
  const std::size_t first = part_of_warp() * part;
  const std::size_t end = first + part < count ? first + part : count;
  Extremes e;
  for (std::size_t i = first + lane; i < end; i += kWarp) {
    const float v = values[i];
    if (v - v == 0)
      e = Wider{}(e, {v, v, kNone});
    else
      e = Wider{}(e, {e.lowest, e.highest, i});
  }
  e = warp_inclusive_scan(e, lane, Wider{});
  if (lane == kWarp - 1 && first < count) results[part_of_warp()] = e;
}

template <class In>
__global__ void sum_channels(const In* values, std::size_t pixels, unsigned channels,
                             Sums* results) {
  const unsigned lane = threadIdx.x % kWarp;
  const std::size_t first = part_of_warp() * kPart;
  const std::size_t end = first + kPart < pixels ? first + kPart : pixels;
  Sums sums;
  for (std::size_t i = first + lane; i < end; i += kWarp)
    for (unsigned c = 0; c < kSatMaxChannels; ++c)
      if (c < channels) sums.of[c] += static_cast<double>(values[i * channels + c]);
  sums = warp_inclusive_scan(sums, lane, Add{});
  if (lane == kWarp - 1 && first < pixels) results[part_of_warp()] = sums;
}

/// Launches one warp for each part of `count` things, and fetches their results.
template <class Result, class Launch>
std::vector<Result> results_of_parts(std::size_t count, std::size_t part, const Stream& stream,
                                     const Launch& launch_grid) {
  const std::size_t parts = (count + part - 1) / part;
  const DeviceArray<Result> results(parts);
  launch_grid(
      Grid{.blocks = static_cast<unsigned>((parts + kWarps - 1) / kWarps), .threads = kThreads},
      results.data());
  std::vector<Result> on_host(parts);
  copy_to_host(results.data(), on_host, stream);
  stream.wait();
  return on_host;
}

}  // namespace

SatRange find_range(const float* pixels, const SatLayout& layout, const Stream& stream) {
  const std::size_t count = layout.pixels() * layout.channels;
  if (count == 0) return {0, 0};
  const auto parts =
      results_of_parts<Extremes>(count, kPart, stream, [&](const Grid& grid, Extremes* results) {
        launch(find_extremes, grid, stream, pixels, count, kPart, results);
      });
  Extremes all;
  for (const Extremes& e : parts) {
    all.lowest = std::min(all.lowest, e.lowest), all.highest = std::max(all.highest, e.highest);
    all.first_not_finite = std::min(all.first_not_finite, e.first_not_finite);
  }
  if (all.first_not_finite != kNone)
    throw_outside(all.first_not_finite, layout,
                  {std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max()});
  return {all.lowest, all.highest};
}

template <class In>
std::array<float, kSatMaxChannels> find_mean(const In* pixels, const SatLayout& layout,
                                             const Stream& stream) {
  std::array<float, kSatMaxChannels> mean{};
  if (layout.pixels() == 0) return mean;
  const auto parts =
      results_of_parts<Sums>(layout.pixels(), kPart, stream, [&](const Grid& grid, Sums* results) {
        launch(sum_channels<In>, grid, stream, pixels, layout.pixels(), layout.channels, results);
      });
  for (std::size_t c = 0; c < layout.channels; ++c) {
    double sum = 0;
    for (const Sums& part : parts) sum += part.of[c];
    mean[c] = static_cast<float>(sum / static_cast<double>(layout.pixels()));
  }
  return mean;
}

void throw_outside(std::size_t value, const SatLayout& layout, const SatRange& range) {
  const std::size_t pixel = value / layout.channels;
  char text[200];
  std::snprintf(text, sizeof(text),
                "summed-area table: pixel (%zu, %zu) channel %zu is not from %g to %g",
                pixel % layout.width, pixel / layout.width, value % layout.channels, range.lowest,
                range.highest);
  throw ValueError(text);
}

template std::array<float, kSatMaxChannels> find_mean(const float*, const SatLayout&,
                                                      const Stream&);
template std::array<float, kSatMaxChannels> find_mean(const std::uint8_t*, const SatLayout&,
                                                      const Stream&);
template std::array<float, kSatMaxChannels> find_mean(const std::uint16_t*, const SatLayout&,
                                                      const Stream&);
template std::array<float, kSatMaxChannels> find_mean(const std::uint32_t*, const SatLayout&,
                                                      const Stream&);

}  // namespace relumbre::cuda
