/// The --exposure option: auto, or stops.
#pragma once

#include <string>

#include "relumbre/image/tone_map.h"

namespace relumbre::cli {

/// Throws CLI::ValidationError for anything else.
ToneConfig parse_exposure(const std::string& text);

}  // namespace relumbre::cli
