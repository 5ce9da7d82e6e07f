/// Small scenes for this module's tests.
#pragma once

#include <string>
#include <utility>

#include "relumbre/geometry/tessellation.h"
#include "relumbre/scene/scene.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre::test {

inline std::uint32_t add_material(Scene& scene, const Rgb& reflectance, const Rgb& emission = {},
                                  bool two_sided = false) {
  Material material;
  material.reflectance = reflectance;
  material.emission = emission;
  material.two_sided = two_sided;
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

/// A parallelogram of two triangles that faces edge1 × edge2, as an object of its own.
inline std::uint32_t add_quad(Scene& scene, std::uint32_t material, const Vec3f& corner,
                              const Vec3f& edge1, const Vec3f& edge2) {
  TriangleMesh& mesh = scene.mesh;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  const auto object = static_cast<std::uint32_t>(scene.objects.size());
  for (const Vec3f& p : {corner, corner + edge1, corner + edge1 + edge2, corner + edge2}) {
    mesh.positions.push_back(p);
  }
  scene.objects.push_back({"object " + std::to_string(object)});
  for (const Index3& corners :
       {Index3{base, base + 1, base + 2}, Index3{base, base + 2, base + 3}}) {
    mesh.triangles.push_back(corners);
    mesh.material.push_back(material);
    mesh.object.push_back(object);
    mesh.two_sided.push_back(scene.materials[material].two_sided ? 1 : 0);
  }
  return object;
}

/// Six quads that face the inside of an axis-aligned box: floor, ceiling, left, right, back, front.
inline void add_room(Scene& scene, std::uint32_t material, const Vec3f& lower, const Vec3f& upper) {
  const Vec3f d = upper - lower, x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
  add_quad(scene, material, lower, z, x);
  add_quad(scene, material, lower + y, x, z);
  add_quad(scene, material, lower, y, z);
  add_quad(scene, material, lower + x, z, y);
  add_quad(scene, material, lower, x, y);
  add_quad(scene, material, lower + z, y, x);
}

inline Light emitter_light(std::uint32_t object) {
  Light light;
  light.name = "emitter";
  light.type = LightType::kEmitter;
  light.object = object;
  return light;
}

/// A quad light with the geometry and normal of add_quad.
inline Light quad_light(const Vec3f& corner, const Vec3f& edge1, const Vec3f& edge2) {
  Light light;
  light.name = "quad";
  light.type = LightType::kQuad;
  light.position = corner;
  light.edge1 = edge1;
  light.edge2 = edge2;
  return light;
}

/// A scene cut into n elements in k patches, objects kept apart.
struct Cut {
  Scene scene;
  Tessellation tessellation;
  RayScene rays;

  Cut(Scene s, std::size_t patches, std::size_t elements)
      : scene(std::move(s)), tessellation(cut(scene, patches, elements)), rays(scene.mesh) {}

  /// Indices of the elements of one object.
  [[nodiscard]] std::vector<std::size_t> elements_of(std::uint32_t object) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < tessellation.elements(); ++i) {
      if (scene.mesh.object[tessellation.facets_of(i)[0].triangle] == object) found.push_back(i);
    }
    return found;
  }

  /// Area-weighted mean of one object's values.
  [[nodiscard]] Rgb mean(std::span<const Rgb> values, std::uint32_t object) const {
    Vec3d sum;
    double area = 0;
    for (const std::size_t i : elements_of(object)) {
      sum += Vec3d(values[i]) * static_cast<double>(tessellation.area[i]);
      area += static_cast<double>(tessellation.area[i]);
    }
    return Rgb(sum / area);
  }

  [[nodiscard]] std::vector<Rgb> reflectances() const {
    return of_materials([](const Material& m) { return m.reflectance; });
  }
  [[nodiscard]] std::vector<Rgb> emissions() const {
    return of_materials([](const Material& m) { return m.emission; });
  }

 private:
  static Tessellation cut(const Scene& scene, std::size_t patches, std::size_t elements) {
    std::vector<std::uint32_t> labels;
    for (const std::uint32_t object : scene.mesh.object) labels.push_back(object + 1);
    return tessellate(scene.mesh, {patches, elements, PatchMethod::kCluster, labels});
  }

  template <class Property>
  [[nodiscard]] std::vector<Rgb> of_materials(Property&& property) const {
    std::vector<Rgb> values;
    for (std::size_t i = 0; i < tessellation.elements(); ++i) {
      values.push_back(property(scene.material_of(tessellation.facets_of(i)[0].triangle)));
    }
    return values;
  }
};

}  // namespace relumbre::test
