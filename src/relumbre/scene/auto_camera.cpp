#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "relumbre/base/box.h"
#include "relumbre/scene/camera.h"
#include "relumbre/scene/scene.h"

namespace relumbre {
namespace {

constexpr float kFieldOfView = 45;
constexpr float kMargin = 1.05F;

/// The sides of the bounding box, in the order -x, +x, -y, +y, -z, +z.
constexpr std::size_t kSides = 6;
constexpr std::size_t kTop = 3;
constexpr std::array<std::size_t, 4> kAround = {0, 1, 4, 5};

Vec3f outwards(std::size_t side) {
  Vec3f direction;
  direction[side / 2] = side % 2 == 0 ? -1.0F : 1.0F;
  return direction;
}

Box bounds_of(const TriangleMesh& mesh) {
  Box box;
  for (const Index3& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) box.extend(mesh.positions[vertex]);
  }
  return box;
}

/// The share of each side of the box that triangles lying along it cover.
std::array<float, kSides> coverage(const TriangleMesh& mesh, const Box& box) {
  constexpr float depth = 0.1F;  // of the box: how far in a wall may stand
  constexpr float along = 0.7F;  // cosine: how far a wall may lean
  const Vec3f size = box.size(), center = box.center();
  std::array<float, kSides> covered{};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3f normal = mesh.scaled_normal(t);
    const Vec3f middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(std::abs(normal[axis]) > along * length(normal))) continue;
      const float place = (middle[axis] - box.lower[axis]) / size[axis];
      if (place > depth && place < 1 - depth) continue;
      const std::size_t side = 2 * axis + (middle[axis] > center[axis] ? 1 : 0);
      covered[side] += std::abs(normal[axis]) / 2;
    }
  }
  for (std::size_t side = 0; side < kSides; ++side) {
    const std::size_t axis = side / 2;
    covered[side] /= size[(axis + 1) % 3] * size[(axis + 2) % 3];
  }
  return covered;
}

/// Distance from which something of this half-height fits the field of view.
float framing_distance(float half_height) {
  const float half_angle = kFieldOfView / 2 * std::numbers::pi_v<float> / 180;
  return kMargin * half_height / std::tan(half_angle);
}

Camera looking(const Vec3f& eye, const Vec3f& target) {
  Camera camera;
  camera.name = "auto";
  camera.eye = eye;
  camera.target = target;
  camera.vfov_deg = kFieldOfView;
  return camera;
}

/// Straight into the opening; a square picture shows all of it.
Camera through_opening(const Box& box, std::size_t side) {
  const Vec3f size = box.size(), out = outwards(side);
  const std::size_t across = side / 2 == 0 ? 2 : 0;
  const float half_height = std::max(size.y, size[across]) / 2;
  const float half_depth = size[side / 2] / 2;
  return looking(box.center() + out * (half_depth + framing_distance(half_height)), box.center());
}

/// Three quarters from above; the bounding sphere fits.
Camera from_outside(const Box& box) {
  const float radius = box.diagonal() / 2;
  const float half_angle = kFieldOfView / 2 * std::numbers::pi_v<float> / 180;
  const Vec3f towards_eye = normalized(Vec3f(0.6F, 0.65F, 1.0F));
  return looking(box.center() + towards_eye * (kMargin * radius / std::sin(half_angle)),
                 box.center());
}

/// Distance along `ray` from `origin` to a triangle, or infinity. Source: Möller and Trumbore 1997.
float distance_to(const TriangleMesh& mesh, std::size_t t, const Vec3f& origin, const Vec3f& ray) {
  constexpr float miss = std::numeric_limits<float>::infinity();
  const Vec3f a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a;
  const Vec3f p = cross(ray, ac);
  const float determinant = dot(ab, p);
  if (determinant == 0) return miss;
  const Vec3f s = origin - a;
  const float u = dot(s, p) / determinant;
  const Vec3f q = cross(s, ab);
  const float v = dot(ray, q) / determinant;
  const float distance = dot(ac, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && distance > 0 ? distance : miss;
}

float free_distance(const TriangleMesh& mesh, const Vec3f& origin, const Vec3f& ray) {
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    nearest = std::min(nearest, distance_to(mesh, t, origin, ray));
  }
  return nearest;
}

/// From the corner with the longest free view across the room, a little below its middle height.
Camera from_inside(const TriangleMesh& mesh, const Box& box) {
  constexpr float inset = 0.12F, eye_height = 0.6F, target_height = 0.4F;
  const Vec3f size = box.size();
  Camera best;
  float longest = -1;
  for (int corner = 0; corner < 4; ++corner) {
    const float x = (corner & 1) != 0 ? 1 - inset : inset,
                z = (corner & 2) != 0 ? 1 - inset : inset;
    const Vec3f eye = box.lower + size * Vec3f(x, eye_height, z);
    const Vec3f target = box.lower + size * Vec3f(1 - x, target_height, 1 - z);
    const float distance = free_distance(mesh, eye, normalized(target - eye));
    if (distance <= longest) continue;
    longest = distance;
    best = looking(eye, target);
  }
  best.vfov_deg = 60;
  return best;
}

}  // namespace

Camera auto_camera(const Scene& scene) {
  if (!scene.cameras.empty()) return scene.cameras.front();
  const Box box = bounds_of(scene.mesh);
  if (box.empty() || !(box.diagonal() > 0)) return {};

  constexpr float wall = 0.5F;
  const std::array<float, kSides> covered = coverage(scene.mesh, box);
  std::size_t walls = 0, open_side = kAround[0];
  for (const std::size_t side : kAround) {
    walls += covered[side] >= wall ? 1 : 0;
    if (covered[side] < covered[open_side]) open_side = side;
  }
  if (walls == 3) return through_opening(box, open_side);
  if (walls == 4 && covered[kTop] >= wall) return from_inside(scene.mesh, box);
  return from_outside(box);
}

}  // namespace relumbre
