#include "relumbre/image/heat_map.h"

#include <algorithm>

namespace relumbre {

Rgb heat_color(float v) {
  const auto ramp = [v](float from, float to) {
    return std::clamp((v - from) / (to - from), 0.0F, 1.0F);
  };
  return {ramp(0.1F, 0.5F), ramp(0.4F, 0.8F),
          0.25F * ramp(0, 0.1F) * (1 - ramp(0.3F, 0.5F)) + ramp(0.75F, 1)};
}

void paint_heat(Image& image, const std::string& channel) {
  const auto values = image.channel(channel);
  const float most = std::max(1.0F, *std::ranges::max_element(values));
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel)
    image.set_rgb(pixel, heat_color(values[pixel] / most));
}

}  // namespace relumbre
