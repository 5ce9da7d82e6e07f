/// A scene: triangles, materials, lights and cameras, all in world space.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/scene/camera.h"
#include "relumbre/scene/light.h"

namespace relumbre {

/// 8-bit sRGB texels, row 0 at v = 0 of glTF (the top of the image). Wraps around.
struct Texture {
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< width · height · 3
  /// Bilinear, linear RGB.
  [[nodiscard]] Rgb sample(Vec2f uv) const;
};

struct Material {
  std::string name;
  Rgb reflectance{0.5F};  ///< diffuse, in [0, kMaxReflectance]; multiplies the texture
  Rgb emission{};         ///< exitance in W/m²; light leaves the front (and the back if two-sided)
  std::uint32_t texture = kNone;  ///< base colour, index into Scene::textures
  bool two_sided = false;
  [[nodiscard]] bool emissive() const { return max_component(emission) > 0; }
};

/// The largest reflectance the library computes with; importers clamp to it.
inline constexpr float kMaxReflectance = 0.99F;

struct Object {
  std::string name;
};

struct Scene {
  TriangleMesh mesh;
  std::vector<Vec2f> texcoords;        ///< empty, or one a vertex of the mesh
  std::vector<Vec3f> shading_normals;  ///< empty, or one a vertex of the mesh, unit
  std::vector<Rgb> colors;  ///< empty, or one a vertex: factors of the reflectance, in [0, 1]
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Object> objects;
  std::vector<Light> lights;  ///< glTF punctual lights and one kEmitter per emissive object
  std::vector<Camera> cameras;

  /// Diffuse reflectance at barycentrics (u, v) of a triangle, texture and vertex colours applied.
  [[nodiscard]] Rgb reflectance(std::uint32_t triangle, float u, float v) const;
  [[nodiscard]] const Material& material_of(std::uint32_t triangle) const {
    return materials[mesh.material[triangle]];
  }
  /// 64-bit hash of geometry and materials' sidedness: what the counts depend on.
  [[nodiscard]] std::uint64_t geometry_hash() const;
};

}  // namespace relumbre
