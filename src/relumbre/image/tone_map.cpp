#include "relumbre/image/tone_map.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

constexpr std::size_t kGrain = 16384;    // pixels a task
constexpr double kKey = 0.18;            // middle grey
constexpr std::size_t kTrimPercent = 5;  // of the counted pixels, at either end
constexpr float kMaxStops = 100;         // keeps 2^stops finite and above zero

/// Narkowicz 2015, "ACES Filmic Tone Mapping Curve". Rises to 1; x is clamped where it has long
/// got there, which also keeps x * x finite.
float filmic(float x) {
  x = std::min(x, 1e6F);
  return std::min(1.0F, x * (2.51F * x + 0.03F) / (x * (2.43F * x + 0.59F) + 0.14F));
}

float display_value(float exposed, ToneCurve curve) {
  if (!(exposed > 0)) return 0;
  return srgb_encode(curve == ToneCurve::kFilmic ? filmic(exposed) : std::min(exposed, 1.0F));
}

std::vector<float> log_luminances(const Image& image) {
  std::vector<float> logs;
  logs.reserve(image.pixels());
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float y = luminance(image.rgb(i));
    if (y > 0 && std::isfinite(y)) logs.push_back(std::log2(y));
  }
  return logs;
}

/// Calls store(i, display values) for every pixel, in parallel.
template <class Store>
void for_each_display_color(const Image& image, const ToneConfig& config, Store&& store) {
  const float scale = exposure_scale(image, config);
  parallel_for(0, image.pixels(), kGrain,
               [&](std::size_t i) { store(i, display_color(image.rgb(i) * scale, config.curve)); });
}

}  // namespace

float auto_exposure_stops(const Image& image) {
  std::vector<float> logs = log_luminances(image);
  if (logs.empty()) return 0;
  const std::size_t trim = logs.size() * kTrimPercent / 100;
  const auto low = logs.begin() + static_cast<std::ptrdiff_t>(trim);
  const auto high = logs.end() - static_cast<std::ptrdiff_t>(trim);
  std::nth_element(logs.begin(), low, logs.end());
  std::nth_element(low, high - 1, logs.end());
  double sum = 0;
  for (auto log = low; log != high; ++log) sum += *log;
  return static_cast<float>(std::log2(kKey) - sum / static_cast<double>(high - low));
}

float exposure_scale(const Image& image, const ToneConfig& config) {
  if (!std::isfinite(config.exposure_stops)) {
    throw ValueError("tone map: the exposure is not a finite number of stops");
  }
  const float stops =
      config.exposure_stops + (config.auto_exposure ? auto_exposure_stops(image) : 0);
  return std::exp2(std::clamp(stops, -kMaxStops, kMaxStops));
}

Rgb display_color(const Rgb& exposed, ToneCurve curve) {
  return {display_value(exposed.x, curve), display_value(exposed.y, curve),
          display_value(exposed.z, curve)};
}

Image tone_mapped(const Image& image, const ToneConfig& config) {
  Image display = rgb_image(image.width(), image.height());
  for_each_display_color(image, config,
                         [&](std::size_t i, const Rgb& c) { display.set_rgb(i, c); });
  return display;
}

std::vector<std::uint8_t> tone_map(const Image& image, const ToneConfig& config) {
  std::vector<std::uint8_t> bytes(image.pixels() * 3);
  for_each_display_color(image, config, [&](std::size_t i, const Rgb& c) {
    for (std::size_t k = 0; k < 3; ++k) bytes[3 * i + k] = to_byte(c[k]);
  });
  return bytes;
}

}  // namespace relumbre
