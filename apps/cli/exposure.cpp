#include "cli/exposure.h"

#include <cmath>
#include <cstdlib>

#include <CLI/CLI.hpp>

namespace relumbre::cli {

ToneConfig parse_exposure(const std::string& text) {
  ToneConfig tone;
  tone.auto_exposure = text == "auto";
  if (tone.auto_exposure) return tone;
  char* end = nullptr;
  tone.exposure_stops = std::strtof(text.c_str(), &end);
  if (end == text.c_str() || *end != 0 || !std::isfinite(tone.exposure_stops)) {
    throw CLI::ValidationError("--exposure", "must be auto or a number of stops, not " + text);
  }
  return tone;
}

}  // namespace relumbre::cli
