#include "relumbre/radiosity/operator_input.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr std::size_t kMaxPatches = 46340;  // what LAPACK can invert

}  // namespace

void check_operator_input(const OperatorInput& input) {
  validate(input.counts);
  const std::size_t n = input.counts.rows(), k = input.counts.columns;
  if (n == 0 || k == 0) throw ShapeError(fmt::format("counts are {} x {}: empty", n, k));
  if (k > kMaxPatches)
    throw ValueError(
        fmt::format("{} patches exceed {}, the most that fit k x k matrices", k, kMaxPatches));
  if (input.counts.rays == 0) throw ValueError("counts are of 0 rays");
  if (input.patch_offsets.size() != k + 1)
    throw ShapeError(fmt::format("{} patch offsets for {} patches", input.patch_offsets.size(), k));
  if (input.area.size() != n)
    throw ShapeError(fmt::format("{} areas for {} elements", input.area.size(), n));
  check_reflectance(input.reflectance, n);
}

void check_reflectance(std::span<const Rgb> reflectance, std::size_t elements) {
  if (reflectance.size() != elements)
    throw ShapeError(fmt::format("{} reflectances for {} elements", reflectance.size(), elements));
  for (std::size_t i = 0; i < elements; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(reflectance[i][c] >= 0 && reflectance[i][c] < 1))
        throw ValueError(fmt::format("reflectance of element {}, channel {} is {}, not in [0, 1)",
                                     i, c, reflectance[i][c]));
    }
  }
}

void throw_not_finite(std::span<const float> emission, std::size_t elements) {
  const auto bad = std::ranges::find_if(emission, [](float e) { return !std::isfinite(e); });
  if (bad == emission.end()) throw ValueError("emission is too large for float32 sums");
  const auto at = static_cast<std::size_t>(bad - emission.begin());
  throw ValueError(fmt::format("emission of source {}, element {}, channel {} is {}",
                               at / (3 * elements), at / 3 % elements, at % 3, *bad));
}

}  // namespace relumbre
