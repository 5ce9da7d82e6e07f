/// Form factors on a GPU: rays are made, traced, labelled and counted there, and rows come back.
#pragma once

#include <cstddef>

#include "relumbre/base/progress.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/visibility/bvh.h"

namespace relumbre::cuda {

/// How much is done at a time. Does not change the counts.
struct RowBatchConfig {
  /// That a batch has room for on the device, unless a single row needs more: 8 bytes each. Three
  /// batches are in flight.
  std::size_t counts = std::size_t{1} << 22;
};

/// relumbre::trace_form_factors() on the current device: the same rays, the same sink in the same
/// order, the same errors, and bit-identical counts from run to run. `mesh` is what `tessellation`
/// was made from; its Bvh is built on the CPU first. Counts differ from the CPU's by the few rays
/// that pass so close to an edge that Embree and we see different triangles.
///
/// Memory on the device: see docs/cuda.md; more than is free throws OutOfDeviceMemory before the
/// first ray. On the host: the Bvh while it is built, and the rows of three batches in flight.
/// Cancellation is heard between batches.
void trace_form_factors(const TriangleMesh& mesh, const Tessellation& tessellation,
                        const FormFactorConfig& config, Binning binning, std::size_t first_row,
                        const RowSink& sink, Progress& progress = no_progress(),
                        const RowBatchConfig& batch = {});

/// The same through the Bvh of the mesh, for who has one already. `clearance`: ray_epsilon() of the
/// mesh.
void trace_form_factors(const Bvh& bvh, float clearance, const Tessellation& tessellation,
                        const FormFactorConfig& config, Binning binning, std::size_t first_row,
                        const RowSink& sink, Progress& progress = no_progress(),
                        const RowBatchConfig& batch = {});

/// What BakeConfig::tracer takes to bake on device number `device`.
FormFactorTracer form_factor_tracer(int device);

}  // namespace relumbre::cuda
