/// From lights to radiosity: emission, direct light and everything that bounces.
#pragma once

#include <span>
#include <vector>

#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/render/direct_light.h"

namespace relumbre {

/// n values each, W/m².
struct RelitResult {
  std::vector<Rgb> emission;           ///< of emissive elements, as their lights are set
  std::vector<Rgb> direct_irradiance;  ///< from all lights
  std::vector<Rgb> radiosity;          ///< emission + reflected light of every order
};

/// Summed power of the kEmitter lights that name each of the scene's objects; 0 where none does.
std::vector<Rgb> object_powers(const Scene& scene, std::span<const Light> lights);

/// Exitance of every element with each object's emission scaled by the power of the kEmitter lights
/// that name it: 0 if none does. `emission`: n, at unit power.
std::vector<Rgb> scaled_emission(const Scene& scene, const Tessellation& tessellation,
                                 std::span<const Rgb> emission, std::span<const Light> lights);

/// B = e + operator(ρ ∘ H), with e = scaled_emission() and H = direct_irradiance().
/// The operator is not given e itself: the first bounce of e is part of H, element by element, so
/// it would count twice. reflectance, emission: n. O(n · lights) beside the operator. Throws
/// ShapeError where sizes disagree, and what the operator throws.
RelitResult relight(const Scene& scene, const Tessellation& tessellation,
                    std::span<const Rgb> reflectance, std::span<const Rgb> emission,
                    const RelightOperator& relight_operator, std::span<const Light> lights,
                    std::span<const LightResponse> responses);

/// Total irradiance (B − e) / ρ of every element; NaN in channels that reflect nothing, where B
/// does not tell. All: n.
std::vector<Rgb> total_irradiance(const RelitResult& lit, std::span<const Rgb> reflectance);
/// Total less direct irradiance: what arrived after at least one bounce.
std::vector<Rgb> indirect_irradiance(const RelitResult& lit, std::span<const Rgb> reflectance);

}  // namespace relumbre
