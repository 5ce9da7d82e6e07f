/// The uncompressed reference: iterate B = E + R F B over element-to-element counts.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/base/vec3.h"
#include "relumbre/radiosity/sparse_counts.h"

namespace relumbre {

/// How (I − RF)B = E is iterated. R F is never negative and its rows sum to less than one, so
/// Jacobi and Gauss-Seidel converge from any start (Varga 1962, §3); the matrix is not symmetric,
/// so the Krylov method is BiCGSTAB (van der Vorst 1992).
enum class SolveMethod {
  kJacobi,       ///< one more bounce an iteration; threaded
  kGaussSeidel,  ///< about half Jacobi's iterations; on one thread
  kBiCgStab,     ///< two passes over the counts an iteration, far fewer of them; threaded
};
std::string_view to_string(SolveMethod method);

struct SolveConfig {
  SolveMethod method = SolveMethod::kBiCgStab;
  double tolerance = 1e-6;  ///< on ‖E − (I−RF)B‖₂ / ‖E‖₂, per channel
  std::size_t max_iterations = 1000;
};

struct SolveResult {
  std::vector<Rgb> radiosity;  ///< n
  std::size_t iterations = 0;  ///< the most any channel took
  double residual = 0;         ///< the worst channel's, relative; before B is rounded to float
};

/// counts: n × n; reflectance, emission: n. All three channels share each pass over the counts, in
/// double precision; the result does not depend on the number of threads.
/// Cost of an iteration: 8 bytes read and 6 flops a nonzero (twice that for kBiCgStab); memory
/// beside the counts: 72 (Jacobi, Gauss-Seidel) to 216 bytes an element.
/// Throws ShapeError where the sizes disagree; ValueError for counts that validate() refuses, for a
/// reflectance outside [0, 1) and for an emission that is not finite; Error naming the residual
/// where the tolerance is not reached within max_iterations; Cancelled.
SolveResult solve_radiosity(const SparseCounts& counts, std::span<const Rgb> reflectance,
                            std::span<const Rgb> emission, const SolveConfig& config = {},
                            Progress& progress = no_progress());

/// r = E − (I − RF) B, for a-posteriori error bounds. Throws like solve_radiosity.
std::vector<Rgb> residual(const SparseCounts& counts, std::span<const Rgb> reflectance,
                          std::span<const Rgb> emission, std::span<const Rgb> radiosity);

}  // namespace relumbre
