/// How much of each element the scene sees: the weights of V in the compressed operator.
#pragma once

#include <span>
#include <vector>

#include "relumbre/radiosity/sparse_counts.h"

namespace relumbre {

/// Area times the fraction of the element's rays that arrived anywhere, n values, m².
///
/// A patch's light is a mean over its elements. With plain areas that mean is wrong where a patch
/// lies half under a block: the dark half, which nothing sees, would darken what the rest sends. By
/// reciprocity (A_i F_ij = A_j F_ji) the scene sees of element j an area A_j Σ_i F_ji, which is the
/// row sum that the counts already hold. In a closed scene this is the plain area. Elements that
/// see nothing keep a millionth, so that a patch of only those still has a mean. Throws ShapeError
/// if there are not as many areas as rows.
std::vector<float> seen_area(const SparseCounts& counts, std::span<const float> area);

}  // namespace relumbre
