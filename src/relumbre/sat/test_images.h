/// Images that the tests of this module share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "relumbre/base/sampling.h"

namespace relumbre {

/// Values from lowest to highest, the same for a seed on every machine.
inline std::vector<float> noise_image(std::size_t values, std::uint64_t seed, float lowest = 0,
                                      float highest = 1) {
  std::vector<float> image(values);
  RandomStream random(seed);
  for (float& v : image) v = lowest + (highest - lowest) * random.uniform();
  return image;
}

/// All values that an integer type has.
template <class In>
std::vector<In> noise_integers(std::size_t values, std::uint64_t seed) {
  std::vector<In> image(values);
  RandomStream random(seed);
  for (In& v : image) v = static_cast<In>(random.bits());
  return image;
}

/// From 0 to 1, or all that an integer type has.
template <class In>
std::vector<In> noise(std::size_t values, std::uint64_t seed) {
  if constexpr (std::is_same_v<In, float>)
    return noise_image(values, seed);
  else
    return noise_integers<In>(values, seed);
}

}  // namespace relumbre
