/// The element-to-element solution of an opened store, and how far the compressed operator is from
/// it.
#pragma once

#include <string>
#include <vector>

#include "cli/opened_store.h"
#include "relumbre/radiosity/solver.h"

namespace relumbre::cli {

struct ReferenceOptions {
  std::string method = "bicgstab";
  SolveConfig solve;
};

void add_reference_options(CLI::App& command, ReferenceOptions& options);

struct Reference {
  SparseCounts counts;         ///< n × n, from the same rays as the store's
  std::vector<Rgb> emission;   ///< E: directly reflected light, or --emission
  std::vector<Rgb> lamps;      ///< what emissive surfaces add for display; zero with --emission
  std::vector<Rgb> radiosity;  ///< solves (I − RF)B = E
};

/// Traces element-to-element form factors and iterates.
Reference solve_reference(const OpenedStore& store, const ReferenceOptions& options,
                          Session& session);

struct CompressionError {
  double reflected_l2 = 0;  ///< ‖B̃ − B‖ / ‖B‖, area-weighted; B is all reflected light
  double later_l2 = 0;  ///< ‖B̃ − B‖ / ‖B − E‖: of the second bounce and later ones alone
  double largest = 0;   ///< max |B̃ − B| / max |B|
  double residual = 0;  ///< ‖E − (I − RF)B̃‖ / ‖E‖
  double bound = 0;     ///< a posteriori: residual (max norm) / (1 − max ρ), over max |B̃|
};

CompressionError compressed_error(const OpenedStore& store, const Reference& reference,
                                  Session& session);
void report_error(const CompressionError& error, Session& session);

}  // namespace relumbre::cli
