#include "cli/command.h"

namespace relumbre::cli {

void refuse_negative_counts(CLI::App& command) {
  const CLI::Validator not_negative(
      [](std::string& text) {
        return text.starts_with("-") ? "must not be negative, as " + text + " is" : std::string();
      },
      "");
  for (CLI::Option* option : command.get_options()) {
    const std::string type = option->get_type_name();
    if (type.find("UINT") != std::string::npos || type.find("SIZE") != std::string::npos)
      option->transform(not_negative);  // before what turns 4G into a number
  }
}

void Session::add_options(CLI::App& command) {
  command.add_option("--threads", threads_, "Threads to use (default: all)");
  command.add_option("--json", json_file_, "Write the figures as JSON; - for standard output");
}

void Session::start() {
  limit_ = std::make_unique<ThreadLimit>(threads_);
  report.open(json_file_);
}

void Session::finish() {
  progress.clear();
  report.close();
}

}  // namespace relumbre::cli
