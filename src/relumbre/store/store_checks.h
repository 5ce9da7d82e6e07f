/// What must hold in a baked scene before anything computes with it. All throw ValueError that says
/// which array, at which index, breaks which rule.
#pragma once

#include <span>

#include "relumbre/geometry/tessellation.h"
#include "relumbre/scene/scene.h"

namespace relumbre {

/// Array lengths agree, indices are in range, numbers are finite and in their documented ranges.
void check_scene(const Scene& scene);

/// Offsets rise strictly and end where they should; indices are in range, areas positive, vectors
/// finite; the locator is a forest at most 64 deep, so that locate() always ends.
void check_tessellation(const Tessellation& tessellation, std::size_t source_triangles);

/// One a element; reflectance in [0, kMaxReflectance], emission finite and not negative.
void check_element_materials(std::span<const Rgb> reflectance, std::span<const Rgb> emission,
                             std::size_t elements);

}  // namespace relumbre
