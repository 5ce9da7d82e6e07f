/// What the subcommands that look through a camera share.
#pragma once

#include <cstddef>
#include <string>

#include "cli/picture_options.h"

namespace relumbre::cli {

struct ViewOptions : PictureOptions {
  std::string camera = "auto", size = "1280x720";
};

/// Binds what a picture has, --size, and --camera with this description.
void add_view_options(CLI::App& command, ViewOptions& options, const std::string& camera);

/// Throws CLI::ValidationError.
void parse_size(const std::string& text, std::size_t& width, std::size_t& height);

}  // namespace relumbre::cli
