/// Lights with a surface: quads, and emissive objects of the scene.
///
/// Both combine two ways of choosing a point y on the light, seen from a receiver x, by the
/// one-sample balance heuristic (Veach and Guibas 1995): uniformly in area, and by a
/// cosine-weighted direction from the receiver. With G = cosθ cosθ' / |x−y|², exitance M and
/// density p of area sampling, a sample brings
///
///     (M/π) G / (s G/π + (1−s) p),       s: share of the cosine-weighted samples
///
/// which stays below M/s however close the light is. ProbePolicy chooses s.
#pragma once

#include <memory>

#include "relumbre/render/light_sampler.h"

namespace relumbre {

/// A one-sided parallelogram of exitance 1 W/m² that shines where edge1 × edge2 points.
/// Throws ValueError if it has no area.
std::unique_ptr<LightSampler> make_quad_sampler(const Light& light, float epsilon);

/// All emissive triangles of scene.objects[light.object], each with its material's exitance, chosen
/// by area times luminance. They light from the front, and from the back where they are two-sided.
/// Throws ValueError if there is no such object. An object that emits nothing brings nothing.
std::unique_ptr<LightSampler> make_emitter_sampler(const Scene& scene, const Light& light,
                                                   float epsilon);

}  // namespace relumbre
