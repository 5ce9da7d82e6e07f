/// What every element reflects and emits: materials and textures averaged over its facets.
#pragma once

#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/scene/scene.h"

namespace relumbre {

struct ElementMaterials {
  std::vector<Rgb> reflectance;  ///< n, in [0, kMaxReflectance]
  std::vector<Rgb> emission;     ///< n, exitance in W/m², every emitter at its own strength
};

/// Area-weighted means over the facets of each element. Textures are averaged over each facet with
/// low-discrepancy points, about one a texel it covers (at least 8, at most 4,096). A surface that
/// is not two-sided has no back facets, so nothing is emitted there. Deterministic and parallel.
/// `tessellation` must be of scene.mesh. O(facets + texels covered).
ElementMaterials element_materials(const Scene& scene, const Tessellation& tessellation);

}  // namespace relumbre
