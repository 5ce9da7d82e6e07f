/// Figures as SVG: text that stands alone, for files and for inside HTML.
#pragma once

#include <string>

#include "relumbre/plot/figure.h"

namespace relumbre {

/// The figure as an SVG document without scripts, fonts, identifiers or anything loaded, so that
/// several can stand in one page. The same figure gives the same bytes, whatever the locale.
/// Every mark lies within its axes; the legend names each series once.
/// Throws ValueError naming the panel or the axis: no panels, an empty panel, a value that is not
/// finite, not positive on a logarithmic axis, no category, or outside a fixed range; a size out of
/// range; more than a million marks.
std::string to_svg(const Figure& figure);

}  // namespace relumbre
