/// What a camera sees: hits with surfaces culled that are seen from behind.
#pragma once

#include <span>

#include "relumbre/scene/scene.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

/// hits[i] = the closest hit along rays[i] that is not the back of a one-sided triangle, so that
/// one can look into a room from outside. At most 64 such backs are passed; beyond, nothing is hit.
void trace_primary(const Scene& scene, const RayScene& rays, std::span<const Ray> primary,
                   std::span<Hit> hits);

/// A point that a camera sees.
struct Surface {
  Vec3f position;
  Vec3f normal;          ///< unit, of the triangle, on the side that was hit
  Vec3f shading_normal;  ///< unit, interpolated if the scene has shading normals
  Rgb reflectance;
};

/// `hit` must be one, on `scene`.
Surface surface_at(const Scene& scene, const Hit& hit);

}  // namespace relumbre
