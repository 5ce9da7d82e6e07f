/// Colours and marks that tell series apart.
#pragma once

#include <cstddef>
#include <string>

#include "relumbre/plot/figure.h"

namespace relumbre {

/// How series number `index` of `count` looks.
struct SeriesStyle {
  std::string color;     ///< "#rrggbb"
  std::size_t mark = 0;  ///< one of kMarks
  std::string dashes;    ///< SVG's stroke-dasharray; empty: solid
};

constexpr std::size_t kMarks = 8;

/// Distinct colours are those of Okabe and Ito 2008, without the yellow that white hides, and come
/// again with dashes; ordered ones are from viridis (Smith and van der Walt 2015), without its
/// light end.
SeriesStyle series_style(SeriesColors palette, std::size_t index, std::size_t count);

}  // namespace relumbre
