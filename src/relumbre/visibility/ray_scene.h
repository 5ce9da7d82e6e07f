/// Closest-hit and occlusion queries over a triangle mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/triangle_mesh.h"

namespace relumbre {

struct Ray {
  Vec3f origin;
  float t_min = 0;
  Vec3f direction;  ///< need not have unit length; t is in units of it
  float t_max = std::numeric_limits<float>::infinity();
};

struct Hit {
  std::uint32_t triangle = kNone;  ///< kNone: the ray left the scene
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;  ///< barycentric weights of corners 1 and 2
  bool back = false;   ///< the ray met the back of the triangle
  explicit operator bool() const { return triangle != kNone; }
};

/// Sixteen rays side by side, the form in which the CPU traces them fastest.
///
///   origin    x0 x1 ... x15 | y0 y1 ... y15 | z0 z1 ... z15       directions likewise
struct alignas(64) RayPacket {
  static constexpr std::size_t kSize = 16;
  using Lanes = std::array<float, kSize>;
  std::array<Lanes, 3> origin;
  std::array<Lanes, 3> direction;
  Lanes t_min;
  Lanes t_max;
};

/// What sixteen rays met: the members of Hit, lane by lane.
struct alignas(64) HitPacket {
  std::array<std::uint32_t, RayPacket::kSize> triangle;  ///< kNone where the ray left the scene
  std::array<std::uint32_t, RayPacket::kSize> back;      ///< 1 where it met the back
  RayPacket::Lanes t, u, v;                              ///< only meaningful where it hit
};

/// An acceleration structure over a mesh (Embree 3 or 4, high-quality build, robust traversal, so
/// that a ray through a shared edge always hits). Immutable; all queries are thread-safe.
///
/// Of several triangles at the same distance any one may be reported, and which one can depend on
/// the rays traced along with it; the same call always gives the same answer.
class RayScene {
 public:
  /// Copies what it needs; the mesh may go. A mesh without triangles is never hit. Throws
  /// ValueError if a triangle refers to a position that is not there, Error if Embree refuses (out
  /// of memory).
  explicit RayScene(const TriangleMesh& mesh);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  [[nodiscard]] Hit closest(const Ray& ray) const;
  [[nodiscard]] bool occluded(const Ray& ray) const;
  /// hits[i] = closest(rays[i]), sixteen rays at a time. Made for neighbours in the array that go
  /// much the same way: on those it is about twice as fast as one by one, on unordered rays it is
  /// up to a quarter slower. Throws ShapeError if the sizes differ.
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const;
  /// blocked[i] = occluded(rays[i]); the same holds.
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const;

  /// Traces the first `active` lanes of a packet; the other lanes of `hits` become misses.
  void closest(const RayPacket& rays, HitPacket& hits, std::size_t active = RayPacket::kSize) const;

  /// How far to start a ray off a surface so that it does not hit it again: 1e-5 of the scene's
  /// largest coordinate.
  [[nodiscard]] float epsilon() const;
  /// Bytes that the structure holds, its copy of the mesh included. Two structures that are built
  /// at the same moment may be charged for one another.
  [[nodiscard]] std::size_t bytes() const;
  /// The ray tracer and its version, for reports: "Embree 3.13.5".
  static const char* implementation();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace relumbre
