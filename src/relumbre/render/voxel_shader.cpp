#include "relumbre/render/voxel_shader.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace relumbre {

namespace {

constexpr Rgb kGrey(0.6F);

/// Of the face that the ray came in by; of one that faces it if it began inside.
Vec3f face_normal(const CastRay& ray, const TreeHit& hit) {
  if (hit.voxel.axis < 0) return -normalized(Vec3f(ray.direction));
  Vec3f n;
  const auto axis = static_cast<std::size_t>(hit.voxel.axis);
  n[axis] = ray.direction[axis] > 0 ? -1.0F : 1.0F;
  return n;
}

}  // namespace

Rgb VoxelShader::color(const CastRay& ray, const TreeHit& hit) const {
  const Look seen = look(ray, hit);
  switch (shading_) {
    case VoxelShading::kColor:
      return seen.color;
    case VoxelShading::kNormal:
      return (seen.normal + Vec3f(1)) * 0.5F;
    case VoxelShading::kLit:
      break;
  }
  const Vec3f toward_eye = -normalized(Vec3f(ray.direction));
  constexpr float sky = 0.2F, lamp = 0.8F;
  return seen.color * (sky + lamp * std::max(0.0F, dot(seen.normal, toward_eye)));
}

Vec3f VoxelShader::normal(const CastRay& ray, const TreeHit& hit) const {
  return look(ray, hit).normal;
}

VoxelShader::Look VoxelShader::look(const CastRay& ray, const TreeHit& hit) const {
  Look seen{kGrey, {}};
  if (tree_.has_values()) seen = smooth_ ? interpolated(ray, hit) : stored(ray, hit.child);
  if (!(length(seen.normal) > 0)) seen.normal = face_normal(ray, hit);
  return seen;
}

VoxelShader::Look VoxelShader::stored(const CastRay& ray, const VoxelTree::Child& child) const {
  const VoxelValue& value = tree_.value(child);
  const Vec3f normal = unpack_normal(value.normal);
  if (dot(Vec3d(normal), ray.direction) > 0) return {back_color(value), -normal};
  return {unpack_color(value.color), normal};
}

/// Trilinear between the cells' centres; cells with nothing in them have no say.
VoxelShader::Look VoxelShader::interpolated(const CastRay& ray, const TreeHit& hit) const {
  const std::uint32_t edge = tree_.child_edge(hit.child.level);
  const Vec3d point =
      (ray.origin + ray.direction * hit.voxel.t) / static_cast<double>(edge) - Vec3d(0.5);
  const Vec3d base(std::floor(point.x), std::floor(point.y), std::floor(point.z));
  Look sum{};
  float weights = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    float weight = 1;
    std::array<std::uint32_t, 3> cell;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool up = corner >> a & 1;
      const auto fraction = static_cast<float>(point[a] - base[a]);
      weight *= up ? fraction : 1 - fraction;
      const std::int64_t at = static_cast<std::int64_t>(base[a]) + (up ? 1 : 0);
      cell[a] = static_cast<std::uint32_t>(at * edge);
    }
    const auto child = tree_.find({cell[0], cell[1], cell[2]}, hit.child.level);
    if (!child || !(weight > 0)) continue;
    const Look seen = stored(ray, *child);
    sum.color += seen.color * weight;
    sum.normal += seen.normal * weight;
    weights += weight;
  }
  if (!(weights > 0)) return stored(ray, hit.child);
  return {sum.color / weights, normalized(sum.normal)};
}

}  // namespace relumbre
