#include "relumbre/plot/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace relumbre {

namespace {

constexpr std::array kDistinctColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                     "#e69f00", "#56b4e9", "#444444"};
constexpr std::array<std::array<double, 3>, 6> kViridis{
    {{68, 1, 84}, {65, 68, 135}, {49, 104, 142}, {33, 145, 140}, {53, 183, 121}, {122, 200, 70}}};

std::string ordered_color(std::size_t index, std::size_t count) {
  const double last = static_cast<double>(kViridis.size() - 1);
  const double place =
      count < 2 ? 0 : last * static_cast<double>(index) / static_cast<double>(count - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  std::array<int, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = static_cast<int>(std::lround(
        std::lerp(kViridis[below][c], kViridis[below + 1][c], place - static_cast<double>(below))));
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

}  // namespace

SeriesStyle series_style(SeriesColors palette, std::size_t index, std::size_t count) {
  if (palette == SeriesColors::kOrdered) return {ordered_color(index, count), index % kMarks, ""};
  constexpr std::array dashes{"", "6 3", "2 2", "8 3 2 3"};
  return {kDistinctColors[index % kDistinctColors.size()], index % kMarks,
          dashes[index / kDistinctColors.size() % dashes.size()]};
}

}  // namespace relumbre
