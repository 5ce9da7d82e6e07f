#include "relumbre/base/sampling.h"

#include <bit>

namespace relumbre {

namespace {

/// Direction numbers of the first four dimensions, 32 bits each: column c is what bit c of the
/// index contributes. Primitive polynomials and initial values from new-joe-kuo-6:
/// dimension 2: degree 1, a 0, m {1}; 3: degree 2, a 1, m {1,3}; 4: degree 3, a 1, m {1,3,1}.
constexpr std::array<std::uint32_t, 32> directions(unsigned degree, unsigned a,
                                                   std::array<std::uint32_t, 3> initial) {
  std::array<std::uint32_t, 32> v{};
  for (unsigned i = 0; i < 32; ++i) {
    if (degree == 0) {  // van der Corput
      v[i] = 1U << (31 - i);
    } else if (i < degree) {
      v[i] = initial[i] << (31 - i);
    } else {
      v[i] = v[i - degree] ^ (v[i - degree] >> degree);
      for (unsigned j = 1; j < degree; ++j) {
        if ((a >> (degree - 1 - j)) & 1U) v[i] ^= v[i - j];
      }
    }
  }
  return v;
}

constexpr std::array<std::array<std::uint32_t, 32>, 4> kDirections = {
    directions(0, 0, {}), directions(1, 0, {1, 0, 0}), directions(2, 1, {1, 3, 0}),
    directions(3, 1, {1, 3, 1})};

}  // namespace

std::array<std::uint32_t, 4> sobol4(std::uint32_t index) {
  std::array<std::uint32_t, 4> point{};
  for (; index != 0; index &= index - 1) {
    const auto bit = static_cast<std::size_t>(std::countr_zero(index));
    for (std::size_t d = 0; d < 4; ++d) point[d] ^= kDirections[d][bit];
  }
  return point;
}

}  // namespace relumbre
