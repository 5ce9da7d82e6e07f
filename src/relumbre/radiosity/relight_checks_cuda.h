/// Internal: what the device's operators check before they are made.
#pragma once

#include "relumbre/radiosity/relight_cuda.h"

namespace relumbre::cuda {

/// Throws what DeviceRelight documents.
void check_parts(const RelightParts& parts);
/// Throws ShapeError unless there are k × k values a channel.
void check_transport(const std::array<std::span<const double>, 3>& transport, std::size_t patches);

}  // namespace relumbre::cuda
