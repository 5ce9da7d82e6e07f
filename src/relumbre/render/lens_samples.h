/// Where on the lens, and where in the pixel, a lens-sampled picture's rays start and go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/image/thin_lens.h"

namespace relumbre {

/// One of a pixel's rays.
struct LensSample {
  Vec2f lens;           ///< in the opening within the unit disc
  Vec2f pixel;          ///< from the pixel's centre, in pixels, with the density of a tent
  std::uint32_t index;  ///< in the low-discrepancy sequence
};

/// Scrambled Sobol' points, equally many a pixel: stratified over the lens, and over the pixel's
/// area independently. A pixel takes one of 64 sets, picked by its hash, so that neighbours
/// differ. A set runs through the lens in Morton order: rays that follow each other are nearly the
/// same. Immutable.
class LensSamples {
 public:
  /// O(samples log samples) a set, 20 bytes a sample and set.
  LensSamples(const Aperture& aperture, std::uint32_t samples, std::uint64_t seed);

  [[nodiscard]] std::span<const LensSample> of_pixel(std::size_t pixel) const;

 private:
  std::vector<std::vector<LensSample>> sets_;
  std::uint64_t seed_;
};

}  // namespace relumbre
