/// Puts a Scene together from triangles, quads and smooth surfaces.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "relumbre/scene/scene.h"

namespace relumbre {

/// A rigid motion from an object's own frame to the world: x, y, z are orthonormal.
struct Placement {
  Vec3f origin{};
  Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  [[nodiscard]] Vec3f vector(const Vec3f& v) const { return x * v.x + y * v.y + z * v.z; }
  [[nodiscard]] Vec3f point(const Vec3f& p) const { return origin + vector(p); }
  /// The frame `inner`, given in this frame's coordinates, in the world.
  [[nodiscard]] Placement operator*(const Placement& inner) const {
    return {point(inner.origin), vector(inner.x), vector(inner.y), vector(inner.z)};
  }
};

/// Stands at `origin`, turned by `yaw_deg` about +y (counter-clockwise seen from above).
Placement turned(const Vec3f& origin, float yaw_deg);
/// Stands at `origin` with its +y axis along the unit vector `axis`.
Placement along(const Vec3f& origin, const Vec3f& axis);

/// Collects geometry for one Scene. What is added belongs to the current object, has the current
/// material and is given in the current placement. Every vertex gets a shading normal: the face's
/// own for flat pieces, so they share no vertices; the given one for smooth surfaces.
class SceneBuilder {
 public:
  /// Returns its index.
  std::uint32_t add_material(Material material);
  /// A matt, one-sided material.
  std::uint32_t add_matt(std::string name, Rgb reflectance);
  /// A lamp's material: emission is exitance in W/m²; it reflects like frosted glass.
  std::uint32_t add_glowing(std::string name, Rgb emission);
  void add_camera(Camera camera) { scene_.cameras.push_back(std::move(camera)); }

  void begin_object(std::string name);
  void use(std::uint32_t material) { material_ = material; }
  void place(const Placement& placement) { placement_ = placement; }
  [[nodiscard]] const Placement& placement() const { return placement_; }

  /// Flat faces, counter-clockwise seen from the front.
  void triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);
  void quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d);
  /// A smooth surface with one unit normal a point. Triangles without area (at poles) are omitted.
  void surface(std::span<const Vec3f> points, std::span<const Vec3f> normals,
               std::span<const Index3> triangles);

  /// The scene, with one kEmitter light for every object that has an emissive triangle.
  [[nodiscard]] Scene finish() &&;

 private:
  void add_triangle(const Index3& corners);

  Scene scene_;
  Placement placement_;
  std::uint32_t material_ = 0;
};

/// One kEmitter light, on and at its own exitance, for every object with an emissive triangle,
/// in the order of the objects and with their names.
std::vector<Light> emitter_lights(const Scene& scene);

/// Temporarily moves a builder into a frame given in its current one.
class ScopedPlacement {
 public:
  ScopedPlacement(SceneBuilder& builder, const Placement& inner)
      : builder_(builder), outer_(builder.placement()) {
    builder_.place(outer_ * inner);
  }
  ~ScopedPlacement() { builder_.place(outer_); }
  ScopedPlacement(const ScopedPlacement&) = delete;
  ScopedPlacement& operator=(const ScopedPlacement&) = delete;

 private:
  SceneBuilder& builder_;
  Placement outer_;
};

}  // namespace relumbre
