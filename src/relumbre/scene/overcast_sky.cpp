#include "relumbre/scene/overcast_sky.h"

#include <cmath>
#include <numbers>

namespace relumbre {

Image overcast_sky() {
  constexpr std::size_t kWidth = 128, kHeight = 64;
  constexpr float kGround = 0.2F * 7 / 9;  // reflectance · irradiance / π
  Image sky = rgb_image(kWidth, kHeight);
  for (std::size_t row = 0; row < kHeight; ++row) {
    const float polar = std::numbers::pi_v<float> * (static_cast<float>(row) + 0.5F) / kHeight;
    const float sine = std::cos(polar);  // of the altitude
    const float radiance = sine > 0 ? (1 + 2 * sine) / 3 : kGround;
    for (std::size_t column = 0; column < kWidth; ++column) {
      sky.set_rgb(row * kWidth + column, Rgb(radiance));
    }
  }
  return sky;
}

}  // namespace relumbre
