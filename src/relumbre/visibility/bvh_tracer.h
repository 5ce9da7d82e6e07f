/// Rays through our own Bvh on the CPU: the same hits as on a GPU, where Embree is not at hand or
/// would not do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "relumbre/visibility/bvh.h"
#include "relumbre/visibility/bvh_traverse.h"
#include "relumbre/visibility/ray_tracer.h"

namespace relumbre {

BvhRay to_bvh(const Ray& ray);
Hit from_bvh(const BvhHit& hit);

/// hits[i] = trace(scene, rays[i]), on the calling thread, by the CPU's fused multiply-add where it
/// has one. Sizes must be equal.
void trace_closest(const BvhView& scene, std::span<const BvhRay> rays, std::span<BvhHit> hits);
/// blocked[i] = 1 if there is any hit.
void trace_occluded(const BvhView& scene, std::span<const BvhRay> rays,
                    std::span<std::uint8_t> blocked);

class BvhTracer : public RayTracer {
 public:
  /// Throws what build_bvh() throws.
  explicit BvhTracer(const TriangleMesh& mesh) : bvh_(build_bvh(mesh)) {}

  [[nodiscard]] Hit closest(const Ray& ray) const override;
  [[nodiscard]] bool occluded(const Ray& ray) const override;
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const override;
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override;
  void closest(const RayPacket& rays, HitPacket& hits, std::size_t active) const override;
  [[nodiscard]] std::size_t bytes() const override { return bvh_.bytes(); }

  [[nodiscard]] const Bvh& bvh() const { return bvh_; }
  [[nodiscard]] BvhView view() const { return {bvh_.nodes.data(), bvh_.triangles.data()}; }

 private:
  Bvh bvh_;
};

}  // namespace relumbre
