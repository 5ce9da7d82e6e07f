/// What the subcommands that write pictures share: files and exposure.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "relumbre/image/image.h"
#include "relumbre/image/tone_map.h"

namespace relumbre::cli {

struct PictureOptions {
  std::vector<std::string> outputs;
  std::string exposure = "auto", curve = "filmic";
};

/// Binds -o, --exposure and --curve.
void add_picture_options(CLI::App& command, PictureOptions& options);

/// Throws FileError unless all outputs are pictures that can be written.
void check_pictures(const PictureOptions& options, const std::string& command);

/// Throws CLI::ValidationError.
ToneConfig parse_tone(const PictureOptions& options);

/// Reports the exposure and writes all outputs.
void save_pictures(const PictureOptions& options, const Image& image, const ToneConfig& tone,
                   Session& session);

}  // namespace relumbre::cli
