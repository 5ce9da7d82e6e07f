/// What every subcommand shares: options, progress, the report, exit statuses.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/report.h"
#include "cli/terminal_progress.h"
#include "relumbre/base/parallel.h"

namespace relumbre::cli {

enum ExitStatus { kSuccess = 0, kBadInput = 1, kUsage = 2, kInterrupted = 130 };

/// Common options and outputs of one subcommand run.
class Session {
 public:
  /// Adds --threads and --json to `command`.
  void add_options(CLI::App& command);
  /// Applies them; call first in every callback.
  void start();
  /// Writes the JSON report where it was asked for; call last.
  void finish();

  Report report;
  TerminalProgress progress;

 private:
  std::size_t threads_ = 0;
  std::string json_file_;
  std::unique_ptr<ThreadLimit> limit_;
};

/// Options of unsigned types: a minus would wrap around.
void refuse_negative_counts(CLI::App& command);

/// Adds a subcommand whose callback runs `run(options, session)` between start() and finish().
/// `define(command, options)` binds its options. `example` is printed under --help.
template <class Options, class Define, class Run>
void add_command(CLI::App& app, const std::string& name, const std::string& description,
                 const std::string& example, Define define, Run run) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer("Example:\n  " + example);
  auto options = std::make_shared<Options>();
  auto session = std::make_shared<Session>();
  define(*command, *options);
  session->add_options(*command);
  refuse_negative_counts(*command);
  command->callback([options, session, run] {
    session->start();
    run(*options, *session);
    session->finish();
  });
}

void add_scene_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_viewfactors_command(CLI::App& app);
void add_bake_command(CLI::App& app);
void add_relight_command(CLI::App& app);
void add_solve_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_dof_command(CLI::App& app);
void add_voxelize_command(CLI::App& app);
void add_raycast_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_experiment_command(CLI::App& app);

}  // namespace relumbre::cli
