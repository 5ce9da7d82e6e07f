#include "relumbre/radiosity/element_sampler.h"

#include <string>

#include "relumbre/base/error.h"
#include "relumbre/radiosity/ray_generator.h"

namespace relumbre {

ElementSampler::ElementSampler(const Tessellation& tessellation, std::uint32_t rays,
                               std::uint64_t seed, float clearance)
    : tessellation_(tessellation), pattern_(rays), seed_(seed), clearance_(clearance) {}

void ElementSampler::load(std::size_t element, EmittingSurface& surface) const {
  surface.clear();
  for (const Facet& facet : tessellation_.facets_of(element)) {
    const auto& [a, b, c] = facet.corners;
    surface.add(tessellation_.positions[a], tessellation_.positions[b], tessellation_.positions[c],
                clearance_);
  }
  if (surface.size() == 0) throw ValueError("element " + std::to_string(element) + " has no area");
  surface.finish();
}

void ElementSampler::generate(std::size_t element, const EmittingSurface& surface,
                              std::size_t first, std::span<RayPacket> rays) const {
  generate_rays(pattern_, surface, digital_shift(seed_, element), first, rays);
}

}  // namespace relumbre
