/// Turns low-discrepancy points into rays: the inner loop before the ray tracer.
#pragma once

#include <cstddef>
#include <span>

#include "relumbre/radiosity/emitting_surface.h"
#include "relumbre/radiosity/ray_maps.h"
#include "relumbre/radiosity/ray_pattern.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

/// Packets [first, first + rays.size()) of the pattern, leaving `surface` from points uniform in
/// its area, in directions of density cos θ / π about the normal of the facet they leave. t is [0,
/// ∞). `surface` must be finished and not empty. SIMD chosen at run time; one to two ns a ray.
/// Source of the maps: Heitz 2019 (triangle), Shirley and Chiu 1997 (disc). The same maps, one ray
/// at a time: ray_maps.h.
void generate_rays(const RayPattern& pattern, const EmittingSurface& surface,
                   const DigitalShift& shift, std::size_t first, std::span<RayPacket> rays);

}  // namespace relumbre
