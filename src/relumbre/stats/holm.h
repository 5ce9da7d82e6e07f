/// Holm's correction for many tests at once.
#pragma once

#include <span>
#include <vector>

#include "relumbre/stats/distributions.h"

namespace relumbre {

/// The adjusted probabilities, in the order given: the k-th smallest of m is multiplied by
/// m − k + 1, none falls below one that was smaller, none exceeds 1. Rejecting where they are
/// below α keeps the chance of any false rejection below α. Source: Holm 1979.
std::vector<TailProbability> holm(std::span<const TailProbability> tests);

}  // namespace relumbre
