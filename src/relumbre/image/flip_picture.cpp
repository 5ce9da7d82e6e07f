#include <algorithm>
#include <array>
#include <cmath>

#include "relumbre/image/flip.h"
#include "relumbre/image/srgb.h"

namespace relumbre {

namespace {

/// Every 15th of the colour map's 256 entries, sRGB.
constexpr std::array<Rgb, 18> kMagma{{{0.001462F, 0.000466F, 0.013866F},
                                      {0.035520F, 0.028397F, 0.125209F},
                                      {0.102815F, 0.063010F, 0.257854F},
                                      {0.191460F, 0.064818F, 0.396152F},
                                      {0.291366F, 0.064553F, 0.475462F},
                                      {0.384299F, 0.097855F, 0.501002F},
                                      {0.475780F, 0.134577F, 0.507921F},
                                      {0.569172F, 0.167454F, 0.504105F},
                                      {0.664915F, 0.198075F, 0.488836F},
                                      {0.761077F, 0.231214F, 0.460162F},
                                      {0.852126F, 0.276106F, 0.418573F},
                                      {0.925937F, 0.346844F, 0.374959F},
                                      {0.969680F, 0.446936F, 0.360311F},
                                      {0.989363F, 0.557873F, 0.391671F},
                                      {0.996580F, 0.668256F, 0.456192F},
                                      {0.996727F, 0.776795F, 0.541039F},
                                      {0.992440F, 0.884330F, 0.640099F},
                                      {0.987053F, 0.991438F, 0.749504F}}};

Rgb magma(float error) {
  if (!(error > 0)) return kMagma.front();
  const float at = std::min(error, 1.0F) * (kMagma.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), kMagma.size() - 2);
  const float part = at - static_cast<float>(below);
  return kMagma[below] * (1 - part) + kMagma[below + 1] * part;
}

}  // namespace

std::vector<std::uint8_t> error_picture(std::span<const float> error) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * error.size());
  for (const float e : error) {
    const Rgb color = magma(e);
    for (std::size_t c = 0; c < 3; ++c) rgb.push_back(to_byte(color[c]));
  }
  return rgb;
}

}  // namespace relumbre
