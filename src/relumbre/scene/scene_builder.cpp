#include "relumbre/scene/scene_builder.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace relumbre {

namespace {

/// Height over base below 1e-5: what rounding leaves of a quad whose side has shrunk to a pole.
bool has_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const float longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  return length(cross(b - a, c - a)) > 1e-5F * longest;
}

}  // namespace

Placement turned(const Vec3f& origin, float yaw_deg) {
  const float yaw = yaw_deg * std::numbers::pi_v<float> / 180;
  const float c = std::cos(yaw), s = std::sin(yaw);
  return {origin, {c, 0, -s}, {0, 1, 0}, {s, 0, c}};
}

Placement along(const Vec3f& origin, const Vec3f& axis) {
  const Frame frame(axis);
  return {origin, frame.b, axis, frame.t};
}

std::uint32_t SceneBuilder::add_material(Material material) {
  scene_.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene_.materials.size() - 1);
}

std::uint32_t SceneBuilder::add_matt(std::string name, Rgb reflectance) {
  Material material;
  material.name = std::move(name);
  material.reflectance = reflectance;
  return add_material(std::move(material));
}

std::uint32_t SceneBuilder::add_glowing(std::string name, Rgb emission) {
  Material material;
  material.name = std::move(name);
  material.reflectance = Rgb(0.75F);
  material.emission = emission;
  return add_material(std::move(material));
}

void SceneBuilder::begin_object(std::string name) { scene_.objects.push_back({std::move(name)}); }

void SceneBuilder::add_triangle(const Index3& corners) {
  assert(!scene_.objects.empty() && material_ < scene_.materials.size());
  scene_.mesh.triangles.push_back(corners);
  scene_.mesh.material.push_back(material_);
  scene_.mesh.object.push_back(static_cast<std::uint32_t>(scene_.objects.size() - 1));
  scene_.mesh.two_sided.push_back(scene_.materials[material_].two_sided ? 1 : 0);
}

void SceneBuilder::triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f n = normalized(cross(b - a, c - a));
  surface(std::array{a, b, c}, std::array{n, n, n}, std::array<Index3, 1>{{{0, 1, 2}}});
}

void SceneBuilder::quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  const Vec3f n = normalized(cross(c - a, d - b));
  surface(std::array{a, b, c, d}, std::array{n, n, n, n},
          std::array<Index3, 2>{{{0, 1, 2}, {0, 2, 3}}});
}

void SceneBuilder::surface(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                           std::span<const Index3> triangles) {
  assert(points.size() == normals.size());
  const auto first = static_cast<std::uint32_t>(scene_.mesh.positions.size());
  for (const Vec3f& p : points) scene_.mesh.positions.push_back(placement_.point(p));
  for (const Vec3f& n : normals) scene_.shading_normals.push_back(placement_.vector(n));
  for (const auto& [i, j, k] : triangles)
    if (has_area(points[i], points[j], points[k])) add_triangle({first + i, first + j, first + k});
}

Scene SceneBuilder::finish() && {
  scene_.lights = emitter_lights(scene_);
  return std::move(scene_);
}

std::vector<Light> emitter_lights(const Scene& scene) {
  std::vector<bool> glows(scene.objects.size());
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t)
    if (scene.materials[scene.mesh.material[t]].emissive()) glows[scene.mesh.object[t]] = true;
  std::vector<Light> lights;
  for (std::size_t i = 0; i < glows.size(); ++i) {
    if (!glows[i]) continue;
    Light light;
    light.name = scene.objects[i].name;
    light.type = LightType::kEmitter;
    light.object = static_cast<std::uint32_t>(i);
    lights.push_back(std::move(light));
  }
  return lights;
}

}  // namespace relumbre
