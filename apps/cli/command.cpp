#include "cli/command.h"

namespace relumbre::cli {

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
