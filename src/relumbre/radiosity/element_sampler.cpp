#include "relumbre/radiosity/element_sampler.h"

#include "relumbre/radiosity/ray_generator.h"

namespace relumbre {

ElementSampler::ElementSampler(const Tessellation& tessellation, std::uint32_t rays,
                               std::uint64_t seed, float clearance)
    : tessellation_(tessellation), pattern_(rays), seed_(seed), clearance_(clearance) {}

void ElementSampler::load(std::size_t element, EmittingSurface& surface) const {
  load_element(tessellation_, element, clearance_, surface);
}

void ElementSampler::generate(std::size_t element, const EmittingSurface& surface,
                              std::size_t first, std::span<RayPacket> rays) const {
  generate_rays(pattern_, surface, digital_shift(seed_, element), first, rays);
}

}  // namespace relumbre
