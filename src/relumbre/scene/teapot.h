/// The Utah teapot, tessellated from its Bézier patches.
#pragma once

#include "relumbre/scene/scene_builder.h"

namespace relumbre {

/// Stands a teapot on y = 0 in the builder's placement, the spout towards +x, `height` metres high
/// (it is 2.05 times as long), with smooth shading normals. Every patch becomes
/// 2·subdivisions² triangles; those at the poles that have no area are omitted.
///
/// Newell's surfaces leave slits: between lid and rim, in the spout's mouth, and where handle and
/// spout end inside the body. Here they are closed, so that the teapot is the union of three
/// watertight solids and no ray from outside meets a back face.
/// Source: Newell 1975; Crow 1987, "The Origins of the Teapot". subdivisions ≥ 2.
void add_teapot(SceneBuilder& builder, float height, int subdivisions = 10);

}  // namespace relumbre
