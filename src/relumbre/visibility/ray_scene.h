/// Closest-hit and occlusion queries over a triangle mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/visibility/ray.h"

namespace relumbre {

class RayTracer;

/// An acceleration structure over a mesh: Embree's (version 3 or 4, high-quality build), unless
/// another is given. A ray through a shared edge always hits. Immutable; all queries are
/// thread-safe.
///
/// Of several triangles at the same distance any one may be reported, and which one can depend on
/// the rays traced along with it; the same call always gives the same answer.
class RayScene {
 public:
  /// Copies what it needs; the mesh may go. A mesh without triangles is never hit. Throws
  /// ValueError if a triangle refers to a position that is not there, Error if Embree refuses (out
  /// of memory).
  explicit RayScene(const TriangleMesh& mesh);
  /// Rays that `tracer` traces. `epsilon`: ray_epsilon() of its mesh.
  RayScene(std::unique_ptr<const RayTracer> tracer, float epsilon);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  [[nodiscard]] Hit closest(const Ray& ray) const;
  [[nodiscard]] bool occluded(const Ray& ray) const;
  /// hits[i] = closest(rays[i]). Embree takes sixteen rays at a time. Made for neighbours in the
  /// array that go much the same way: on those it is about twice as fast as one by one, on
  /// unordered rays it is up to a quarter slower. Throws ShapeError if the sizes differ.
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const;
  /// blocked[i] = occluded(rays[i]); the same holds.
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const;

  /// Traces the first `active` lanes of a packet; the other lanes of `hits` become misses.
  void closest(const RayPacket& rays, HitPacket& hits, std::size_t active = RayPacket::kSize) const;

  /// Rays a call from which on the tracer works at full speed: sixteen on the CPU, many thousands
  /// where each call has a way to go.
  [[nodiscard]] std::size_t preferred_batch() const;
  /// True where rays had better be gathered for a call, even if that mixes those of many pixels.
  [[nodiscard]] bool wants_long_batches() const { return preferred_batch() > RayPacket::kSize; }
  /// See ray_epsilon().
  [[nodiscard]] float epsilon() const { return epsilon_; }
  /// Bytes that the structure holds, its copy of the mesh included. Two structures that are built
  /// at the same moment may be charged for one another.
  [[nodiscard]] std::size_t bytes() const;
  /// The CPU's ray tracer and its version, for reports: "Embree 3.13.5".
  static const char* implementation();

 private:
  std::unique_ptr<const RayTracer> tracer_;
  float epsilon_ = 0;
};

}  // namespace relumbre
