/// The options of a lens, and what it is focused on.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "relumbre/image/thin_lens.h"

namespace relumbre::cli {

struct LensOptions {
  ThinLens lens;
  Aperture aperture;
  std::optional<double> focus_distance;
  std::vector<int> focus_pixel;  ///< empty, or x and y
  std::string focus = "center";  ///< center or nearest

  /// True if the depth of the picture decides what is in focus.
  [[nodiscard]] bool needs_depth() const { return !focus_distance; }
  /// The lens, focused. `depth`: width · height; empty where it is not needed. Throws ValueError.
  [[nodiscard]] ThinLens focused(std::span<const float> depth, std::size_t width,
                                 std::size_t height) const;
};

/// Binds --focal-length, --f-number, --sensor-width, --focus-distance, --focus-pixel, --focus,
/// --blades and --blade-rotation.
void add_lens_options(CLI::App& command, LensOptions& options);

}  // namespace relumbre::cli
