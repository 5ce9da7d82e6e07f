/// What the tests of this module share.
#pragma once

#include <concepts>
#include <cstddef>
#include <random>
#include <type_traits>
#include <vector>

namespace relumbre::scan_testing {

/// Uniform in [low, high], always the same.
template <class T>
std::vector<T> random_values(std::size_t size, T low, T high) {
  std::mt19937_64 random(size);
  std::vector<T> values(size);
  if constexpr (std::integral<T>) {
    using Wide = std::conditional_t<std::signed_integral<T>, long long, unsigned long long>;
    std::uniform_int_distribution<Wide> uniform(low, high);
    for (T& v : values) v = static_cast<T>(uniform(random));
  } else {
    std::uniform_real_distribution<T> uniform(low, high);
    for (T& v : values) v = uniform(random);
  }
  return values;
}

/// Where a scan that goes by tiles and vectors could go wrong.
inline std::vector<std::size_t> sizes_around(std::size_t tile) {
  return {0, 1, 2, 3, 63, 64, 65, tile - 1, tile, tile + 1, 3 * tile + 37};
}

}  // namespace relumbre::scan_testing
