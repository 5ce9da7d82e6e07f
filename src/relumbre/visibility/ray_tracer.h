/// What a RayScene asks its rays of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/visibility/ray.h"

namespace relumbre {

/// An acceleration structure with the queries of RayScene, whose contracts they share. Immutable;
/// thread-safe. Spans are of equal sizes.
class RayTracer {
 public:
  virtual ~RayTracer() = default;
  [[nodiscard]] virtual Hit closest(const Ray& ray) const = 0;
  [[nodiscard]] virtual bool occluded(const Ray& ray) const = 0;
  virtual void closest(std::span<const Ray> rays, std::span<Hit> hits) const = 0;
  virtual void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const = 0;
  virtual void closest(const RayPacket& rays, HitPacket& hits, std::size_t active) const = 0;
  [[nodiscard]] virtual std::size_t preferred_batch() const { return RayPacket::kSize; }
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

/// Embree 3 or 4, high-quality build, robust traversal. See RayScene's constructor.
std::unique_ptr<const RayTracer> make_embree_tracer(const TriangleMesh& mesh);

/// How far to start a ray off a surface so that it does not hit it again: 1e-5 of the largest
/// finite coordinate.
float ray_epsilon(const TriangleMesh& mesh);

}  // namespace relumbre
