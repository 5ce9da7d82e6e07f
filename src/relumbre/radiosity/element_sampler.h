/// The rays of a tessellation's elements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "relumbre/geometry/tessellation.h"
#include "relumbre/radiosity/emitting_surface.h"
#include "relumbre/radiosity/ray_pattern.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

/// Quasi-random rays from whole elements: points uniform in area over an element's facets,
/// directions cosine-weighted about the facet's own normal. Ray r of element i depends on nothing
/// but (seed, i, r) and the element's facets. Thread-safe.
///
/// Randomisation is a digital shift. Owen scrambling of the same dimensions was measured too.
/// Relative RMSE on parallel unit squares of two triangles each, 400 randomisations, shift / Owen:
/// 256 rays 10.2% / 7.1%, 512 rays 3.6% / 4.0%, 1,024 rays 2.3% / 2.7%, 4,096 rays 0.9% / 1.2%.
class ElementSampler {
 public:
  /// `clearance`: how far from the surface rays start, RayScene::epsilon(). `tessellation` must
  /// outlive the sampler. Throws ValueError for a number of rays that RayPattern refuses.
  ElementSampler(const Tessellation& tessellation, std::uint32_t rays, std::uint64_t seed,
                 float clearance);

  [[nodiscard]] const RayPattern& pattern() const { return pattern_; }
  /// Makes `surface` the element's. Throws ValueError for an element without area. O(facets).
  void load(std::size_t element, EmittingSurface& surface) const;
  /// Packets [first, first + rays.size()) of the element's rays. `surface` is what load() made.
  void generate(std::size_t element, const EmittingSurface& surface, std::size_t first,
                std::span<RayPacket> rays) const;

 private:
  const Tessellation& tessellation_;
  RayPattern pattern_;
  std::uint64_t seed_;
  float clearance_;
};

}  // namespace relumbre
