/// Form factors one ray after the other: what a GPU does, on the CPU.
#pragma once

#include <cstdint>
#include <span>

#include "relumbre/radiosity/form_factors.h"
#include "relumbre/visibility/bvh_tracer.h"

namespace relumbre {

/// The rows of these elements, in this order, by ray_maps.h and our own Bvh, on all threads. A
/// reference for tests and benchmarks of the GPU side, with which it agrees to the last ray; bakes
/// on the CPU are faster with trace_form_factors(). `clearance`: ray_epsilon() of the mesh. Throws
/// ValueError for a number of rays that RayPattern refuses or an element without area.
FormFactors scalar_form_factors(const BvhTracer& scene, float clearance,
                                const Tessellation& tessellation, const FormFactorConfig& config,
                                Binning binning, std::span<const std::uint32_t> elements);

}  // namespace relumbre
