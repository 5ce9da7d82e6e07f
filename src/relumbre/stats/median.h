/// The value in the middle.
#pragma once

#include <vector>

namespace relumbre {

/// The middle value in order of size; of an even number the mean of the two in the middle.
/// O(n log n). `values` is not empty and has no NaN.
double median_of(std::vector<double> values);

}  // namespace relumbre
