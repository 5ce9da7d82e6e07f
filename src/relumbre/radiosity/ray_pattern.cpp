#include "relumbre/radiosity/ray_pattern.h"

#include <algorithm>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"

namespace relumbre {

namespace {

constexpr std::array<std::size_t, 4> kDimensions = {1, 3, 0, 2};

/// abcd... -> 0a0b0c0d...
constexpr std::uint64_t spread_bits(std::uint32_t bits) {
  std::uint64_t x = bits;
  x = (x | (x << 16)) & 0x0000FFFF0000FFFFULL;
  x = (x | (x << 8)) & 0x00FF00FF00FF00FFULL;
  x = (x | (x << 4)) & 0x0F0F0F0F0F0F0F0FULL;
  x = (x | (x << 2)) & 0x3333333333333333ULL;
  return (x | (x << 1)) & 0x5555555555555555ULL;
}

struct Keyed {
  std::uint64_t morton;
  std::array<std::uint32_t, 4> point;
};

}  // namespace

RayPattern::RayPattern(std::uint32_t rays) : rays_(rays) {
  if (rays < 1 || rays > (1U << 26)) {
    throw ValueError("rays an element: " + std::to_string(rays) + ", but must be 1 to 2^26");
  }
  std::vector<Keyed> keyed(rays);
  for (std::uint32_t r = 0; r < rays; ++r) {
    const std::array<std::uint32_t, 4> p = sobol4(r);
    for (std::size_t d = 0; d < 4; ++d) keyed[r].point[d] = p[kDimensions[d]];
    keyed[r].morton = spread_bits(keyed[r].point[2]) | spread_bits(keyed[r].point[3]) << 1;
  }
  std::sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return a.morton != b.morton ? a.morton < b.morton : a.point < b.point;
  });
  for (std::size_t d = 0; d < 4; ++d) {
    coordinate_[d].assign((std::size_t{rays} + 15) / 16 * 16, 0);
    for (std::size_t r = 0; r < rays; ++r) coordinate_[d][r] = keyed[r].point[d];
  }
}

}  // namespace relumbre
