/// What every operator checks before it is made, and the test that a field is finite.
#pragma once

#include <span>

#include "relumbre/radiosity/relight_operator.h"

namespace relumbre {

/// Throws what make_compressed_operator documents, but for the patch offsets and areas, which
/// SegmentMean checks.
void check_operator_input(const OperatorInput& input);

/// Throws ShapeError unless there are `elements`, ValueError naming the element and the value for
/// one outside [0, 1).
void check_reflectance(std::span<const Rgb> reflectance, std::size_t elements);

/// Throws ValueError naming source, element and channel of the first value in `emission` (sources ×
/// n × 3) that is not finite, given that a patch mean of source `source` is not.
[[noreturn]] void throw_not_finite(std::span<const float> emission, std::size_t elements);

}  // namespace relumbre
