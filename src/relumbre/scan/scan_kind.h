/// What the scans of both sides, CPU and GPU, have in common.
#pragma once

#include <type_traits>

#include "relumbre/scan/monoid.h"

namespace relumbre {

enum class ScanKind { kInclusive, kExclusive };

/// What sums In into Out without loss: never narrower than Out, and wider for float32.
template <class In, class Out>
using DefaultPlus =
    Plus<std::conditional_t<std::is_same_v<Out, float> && !std::is_same_v<In, float>, double, Out>>;

}  // namespace relumbre
