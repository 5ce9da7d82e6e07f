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

/// The same for the first `active` rays of a packet; the other lanes become misses.
void trace_primary(const Scene& scene, const RayScene& rays, const RayPacket& primary,
                   HitPacket& hits, std::size_t active);

/// behind[i] = what would be seen along rays[i] if the solid or sheet that it hit first were not
/// there: the closest hit deeper than (1 + separation) times hits[i].t that lies on another object,
/// or on the same one outside of its solids which the ray has entered. A ray enters a solid through
/// the front of a one-sided triangle and leaves it through a back. Where it never leaves, because
/// the mesh has no back there (a sheet, a box without a bottom), the closest front at that depth
/// counts. A miss where the ray hits nothing, or nothing more. At most 64 surfaces are passed.
void trace_behind(const Scene& scene, const RayScene& rays, std::span<const Ray> primary,
                  std::span<const Hit> hits, float separation, std::span<Hit> behind);

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
