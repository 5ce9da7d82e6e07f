#include <cstdio>
#include <new>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "relumbre/base/error.h"

namespace {

using namespace relumbre;

void add_commands(CLI::App& app) {
  cli::add_scene_command(app);
  cli::add_info_command(app);
  cli::add_viewfactors_command(app);
  cli::add_bake_command(app);
  cli::add_relight_command(app);
  cli::add_solve_command(app);
  cli::add_render_command(app);
  cli::add_dof_command(app);
  cli::add_compare_command(app);
  cli::add_voxelize_command(app);
  cli::add_raycast_command(app);
  cli::add_simulate_command(app);
  cli::add_experiment_command(app);
}

int fail(int status, std::string_view message) {
  fmt::print(stderr, "relumbre: {}\n", message);
  return status;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Computes how light settles in a fixed scene once, then relights it in milliseconds.",
      "relumbre");
  app.set_version_flag("--version", std::string("relumbre ") + RELUMBRE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Start with:  relumbre scene cornell -o cornell.glb\n"
      "             relumbre bake cornell.glb -o cornell.h5\n"
      "             relumbre render cornell.h5 -o cornell.png\n"
      "Each subcommand has --help with an example.");
  add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? cli::kSuccess : cli::kUsage;
  }
  return cli::kSuccess;
}

}  // namespace

int main(int argc, char** argv) {
  cli::TerminalProgress::catch_interrupts();
  try {
    return run(argc, argv);
  } catch (const Cancelled& error) {
    return fail(cli::kInterrupted, error.what());
  } catch (const std::bad_alloc&) {
    return fail(cli::kBadInput, "out of memory");
  } catch (const std::exception& error) {
    return fail(cli::kBadInput, error.what());
  }
}
