#include "cli/view_options.h"

#include <cstdio>

namespace relumbre::cli {

void add_view_options(CLI::App& command, ViewOptions& o, const std::string& camera) {
  add_picture_options(command, o);
  command.add_option("--camera", o.camera, camera)->capture_default_str();
  command.add_option("--size", o.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
}

void parse_size(const std::string& text, std::size_t& width, std::size_t& height) {
  int read = 0;
  if (std::sscanf(text.c_str(), "%zux%zu%n", &width, &height, &read) != 2 ||
      static_cast<std::size_t>(read) != text.size()) {
    throw CLI::ValidationError("--size",
                               "must read WIDTHxHEIGHT, for example 1280x720, not " + text);
  }
}

}  // namespace relumbre::cli
