#include "cli/opened_store.h"
#include "cli/reference.h"
#include "relumbre/base/error.h"

namespace relumbre::cli {

namespace {

struct Options {
  StoreOptions store;
  ReferenceOptions reference;
  std::string output;
};

void run(const Options& options, Session& session) {
  if (std::filesystem::path(options.output).extension() != ".npy") {
    throw FileError(options.output, "cannot be written: solve writes .npy");
  }
  const OpenedStore store(options.store, session);
  const Reference reference = solve_reference(store, options.reference, session);
  session.report.section("compressed", "The compressed operator against it");
  report_error(compressed_error(store, reference, session), session);

  std::vector<Rgb> radiosity = reference.radiosity;
  for (std::size_t i = 0; i < radiosity.size(); ++i) radiosity[i] += reference.lamps[i];
  const std::size_t shape[] = {radiosity.size(), 3};
  write_npy(options.output, shape, flat(radiosity));
  session.report.figure("output", "wrote", options.output);
}

}  // namespace

void add_solve_command(CLI::App& app) {
  add_command<Options>(
      app, "solve", "The uncompressed reference solution, element to element",
      "relumbre solve cornell.h5 -o reference.npy",
      [](CLI::App& command, Options& o) {
        add_store_options(command, o.store);
        add_reference_options(command, o.reference);
        command.add_option("-o,--output", o.output, "B.npy, (n,3), W/m²")->required();
      },
      run);
}

}  // namespace relumbre::cli
