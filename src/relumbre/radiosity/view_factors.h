/// Object-to-object view factors with standard errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

struct ViewFactorConfig {
  std::uint64_t rays = 1'000'000;  ///< per object; rounded up to a multiple of the replicates
  std::uint64_t seed = 1;
  std::uint32_t replicates = 32;  ///< independent randomisations that the errors are estimated from
};

/// F_ij is the fraction of what leaves object i diffusely that arrives at a reflecting side of
/// object j. Σ_j F_ij + back_face_i + escaped_i = 1 for an object that has an area, 0 for one that
/// has none.
struct ViewFactorResult {
  std::size_t objects = 0;
  std::uint64_t rays = 0;              ///< per object, as traced
  std::vector<double> area;            ///< objects; m² of all reflecting sides
  std::vector<double> factor;          ///< objects × objects, row i = from object i
  std::vector<double> standard_error;  ///< of factor, same shape
  std::vector<double> back_face;       ///< objects; arrived at the back of a one-sided surface
  std::vector<double> escaped;         ///< objects; left the scene

  [[nodiscard]] double from_to(std::size_t i, std::size_t j) const {
    return factor[i * objects + j];
  }
  [[nodiscard]] double error_from_to(std::size_t i, std::size_t j) const {
    return standard_error[i * objects + j];
  }
};

/// View factors between the objects of `mesh` (mesh.object, each below `objects`). Rays leave the
/// front of every triangle, and the back of two-sided ones, uniformly in area. Each replicate is a
/// digitally shifted Sobol' sequence of rays / replicates points; the factor is the replicates'
/// mean, its standard error that of the mean. `rays` must be made from `mesh`. The same seed gives
/// the same result on any number of threads. Cost: objects · rays; 4 · objects · replicates bytes
/// besides the result. Throws ShapeError where the mesh's arrays disagree, ValueError for an object
/// out of range, fewer than 2 replicates, or more than 2^26 rays a replicate; Cancelled. Source of
/// the error estimate: Owen 2023, "Practical Quasi-Monte Carlo Integration", ch. 17.
ViewFactorResult view_factors(const TriangleMesh& mesh, std::size_t objects, const RayScene& rays,
                              const ViewFactorConfig& config, Progress& progress = no_progress());

}  // namespace relumbre
