/// What the subcommands that make pictures share: size, camera, exposure.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/command.h"
#include "relumbre/image/tone_map.h"
#include "relumbre/scene/camera.h"

namespace relumbre::cli {

struct ViewOptions {
  std::vector<std::string> outputs;
  std::string camera = "auto", size = "1280x720", exposure = "auto", curve = "filmic";
};

/// Binds -o, --size, --exposure and --curve, and --camera with this description.
void add_view_options(CLI::App& command, ViewOptions& options, const std::string& camera);

/// Throws FileError unless all outputs are pictures that can be written.
void check_pictures(const ViewOptions& options, const std::string& command);

/// Throw CLI::ValidationError.
void parse_size(const std::string& text, std::size_t& width, std::size_t& height);
ToneConfig parse_tone(const ViewOptions& options);

/// Reports the exposure and writes all outputs.
void save_pictures(const ViewOptions& options, const Image& image, const ToneConfig& tone,
                   Session& session);

}  // namespace relumbre::cli
