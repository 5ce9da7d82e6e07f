/// What sixteen rays landed on, found side by side.
#pragma once

#include <array>
#include <cstdint>

#include "relumbre/geometry/label_locator.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

/// Labels of hits, lane by lane: the locator's, which are smaller, or one of these two.
struct alignas(64) HitLabels : std::array<std::uint32_t, RayPacket::kSize> {};
inline constexpr std::uint32_t kAbsorbed = 0x7FFFFFFE;  ///< a side that does not reflect
inline constexpr std::uint32_t kEscaped = 0x7FFFFFFF;   ///< the ray left the scene

/// labels[i] = locator.find(...) of hit i. All sixteen go down their quadtrees together, since a
/// branch on how deep each goes is mostly guessed wrong. SIMD chosen at run time.
void find_labels(const LabelLocator& locator, const HitPacket& hits, HitLabels& labels);

}  // namespace relumbre
