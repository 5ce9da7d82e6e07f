#include "relumbre/render/area_light.h"

#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/render/discrete_choice.h"
#include "relumbre/render/probe_policy.h"

namespace relumbre {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A point on a light's surface.
struct LightPoint {
  Vec3f position{};
  Vec3f normal{};  ///< unit, of the front
  bool two_sided = false;
  Rgb exitance{1.0F};
  float density = 0;  ///< of area sampling, 1/m²
};

/// The balance heuristic's estimate: see the header. `geometry` is G.
Rgb balanced(const LightPoint& y, float geometry, float probe_share) {
  const float radiance_over_density =
      geometry / (probe_share * geometry + kPi * (1 - probe_share) * y.density);
  return y.exitance * radiance_over_density;
}

/// Cosine at the light towards the receiver; at most 0 where that side does not shine.
float cosine_at_light(const LightPoint& y, const Vec3f& direction) {
  const float cosine = -dot(y.normal, direction);
  return y.two_sided ? std::abs(cosine) : cosine;
}

/// The shadow ray to y. Its end is moved off the light on the receiver's side, so that neither the
/// light itself nor a surface that it lies in blocks it.
LightRay ray_to(const Receiver& x, const LightPoint& y, float probe_share, float epsilon) {
  const Vec3f to_light = y.position - x.origin;
  const float distance = length(to_light);
  if (!(distance > 0)) return {};
  const Vec3f direction = to_light / distance;
  const float at_light = cosine_at_light(y, direction), at_receiver = dot(x.normal, direction);
  if (at_light <= 0 || at_receiver <= 0) return {};
  const float side = std::copysign(epsilon, -dot(y.normal, direction));
  const float geometry = at_receiver * at_light / (distance * distance);
  if (!(geometry > 0)) return {};
  return {.ray = {x.origin, 0, y.position + y.normal * side - x.origin, 1 - 1e-5F},
          .irradiance = balanced(y, geometry, probe_share)};
}

Vec3f cosine_direction(const Receiver& x, float u, float v) {
  return Frame(x.normal).to_world(square_to_cosine_hemisphere(u, v));
}

/// u in [0, 1) to the same within the samples of area sampling.
float rest_of(float u, float share) { return std::min((u - share) / (1 - share), kBelowOne); }

class QuadSampler final : public LightSampler {
 public:
  QuadSampler(const Light& light, const Vec3f& scaled_normal, float epsilon)
      : corner_(light.position),
        edge1_(light.edge1),
        edge2_(light.edge2),
        scaled_normal_(scaled_normal),
        point_{.normal = normalized(scaled_normal), .density = 1 / length(scaled_normal)},
        policy_(std::array{LightTriangle{{corner_, corner_ + edge1_, corner_ + edge1_ + edge2_}},
                           LightTriangle{{corner_, corner_ + edge1_ + edge2_, corner_ + edge2_}}}),
        epsilon_(epsilon) {}

  [[nodiscard]] bool has_no_extent() const override { return false; }

  [[nodiscard]] LightRay sample(const Receiver& x, float u, float v) const override {
    const float share = policy_.share(x);
    if (u < share) {
      const std::optional<Vec3f> seen = meet(x.origin, cosine_direction(x, u / share, v));
      return seen ? ray_to(x, at(*seen), share, epsilon_) : LightRay{};
    }
    const Vec3f chosen = corner_ + edge1_ * rest_of(u, share) + edge2_ * v;
    return ray_to(x, at(chosen), share, epsilon_);
  }

 private:
  [[nodiscard]] LightPoint at(const Vec3f& position) const {
    LightPoint point = point_;
    point.position = position;
    return point;
  }

  /// Where a ray meets the front of the parallelogram.
  [[nodiscard]] std::optional<Vec3f> meet(const Vec3f& origin, const Vec3f& direction) const {
    const float facing = dot(point_.normal, direction);
    if (!(facing < 0)) return {};
    const float t = dot(corner_ - origin, point_.normal) / facing;
    if (!(t > 0)) return {};
    const Vec3f position = origin + direction * t, offset = position - corner_;
    const float scale = dot(scaled_normal_, scaled_normal_);
    const float a = dot(cross(offset, edge2_), scaled_normal_) / scale;
    const float b = dot(cross(edge1_, offset), scaled_normal_) / scale;
    if (!(a >= 0 && a <= 1 && b >= 0 && b <= 1)) return {};
    return position;
  }

  Vec3f corner_, edge1_, edge2_, scaled_normal_;
  LightPoint point_;
  ProbePolicy policy_;
  float epsilon_;
};

/// The emissive triangles of one object.
class EmitterSampler final : public LightSampler {
 public:
  EmitterSampler(const Scene& scene, std::uint32_t object, std::vector<std::uint32_t> triangles,
                 std::span<const float> weights, const ProbePolicy& policy, float epsilon)
      : scene_(scene),
        object_(object),
        triangles_(std::move(triangles)),
        choice_(weights),
        policy_(policy),
        epsilon_(epsilon) {}

  [[nodiscard]] bool has_no_extent() const override { return false; }

  [[nodiscard]] LightRay sample(const Receiver& x, float u, float v) const override {
    if (!(choice_.total() > 0)) return {};
    const float share = policy_.share(x);
    if (u < share) return probe(x, cosine_direction(x, u / share, v), share);
    const auto [index, rest] = choice_.choose(rest_of(u, share));
    const Vec2f at = square_to_triangle(rest, v);
    return ray_to(x, point(triangles_[index], at.x, at.y), share, epsilon_);
  }

  [[nodiscard]] Rgb probed(const LightRay& light_ray, const Hit& hit) const override {
    if (!hit || scene_.mesh.object[hit.triangle] != object_) return {};
    const LightPoint y = point(hit.triangle, hit.u, hit.v);
    const float at_light = cosine_at_light(y, light_ray.ray.direction);
    if (!(max_component(y.exitance) > 0) || at_light <= 0) return {};
    const float geometry = light_ray.cosine * at_light / (hit.t * hit.t);
    // So close that 1/r² overflows: direction sampling alone has the density there.
    if (!std::isfinite(geometry)) return y.exitance / light_ray.probe_share;
    return balanced(y, geometry, light_ray.probe_share);
  }

 private:
  static LightRay probe(const Receiver& x, const Vec3f& direction, float share) {
    const float cosine = dot(x.normal, direction);
    if (!(cosine > 0)) return {};
    return {.ray = {.origin = x.origin, .direction = direction},
            .probe = true,
            .cosine = cosine,
            .probe_share = share};
  }

  [[nodiscard]] LightPoint point(std::uint32_t triangle, float u, float v) const {
    const TriangleMesh& mesh = scene_.mesh;
    const Material& material = scene_.material_of(triangle);
    const Vec3f a = mesh.corner(triangle, 0);
    return {.position = a + (mesh.corner(triangle, 1) - a) * u + (mesh.corner(triangle, 2) - a) * v,
            .normal = normalized(mesh.scaled_normal(triangle)),
            .two_sided = mesh.two_sided[triangle] != 0,
            .exitance = material.emission,
            .density = luminance(material.emission) / static_cast<float>(choice_.total())};
  }

  const Scene& scene_;
  std::uint32_t object_;
  std::vector<std::uint32_t> triangles_;
  DiscreteChoice choice_;
  ProbePolicy policy_;
  float epsilon_;
};

}  // namespace

std::unique_ptr<LightSampler> make_quad_sampler(const Light& light, float epsilon) {
  const Vec3f scaled_normal = cross(light.edge1, light.edge2);
  const float area = length(scaled_normal);
  if (!(area > 0) || !std::isfinite(area)) {
    throw ValueError(fmt::format("light '{}' has edges that span no area", light.name));
  }
  return std::make_unique<QuadSampler>(light, scaled_normal, epsilon);
}

std::unique_ptr<LightSampler> make_emitter_sampler(const Scene& scene, const Light& light,
                                                   float epsilon) {
  if (light.object >= scene.objects.size()) {
    throw ValueError(fmt::format("light '{}' names object {} of {}", light.name, light.object,
                                 scene.objects.size()));
  }
  const TriangleMesh& mesh = scene.mesh;
  std::vector<std::uint32_t> triangles;
  std::vector<LightTriangle> surface;
  std::vector<float> weights;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.object[t] != light.object || !scene.material_of(t).emissive()) continue;
    triangles.push_back(t);
    surface.push_back(
        {{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, mesh.two_sided[t] != 0});
    const float area = length(mesh.scaled_normal(t)) / 2;
    weights.push_back(area * luminance(scene.material_of(t).emission));
  }
  return std::make_unique<EmitterSampler>(scene, light.object, std::move(triangles), weights,
                                          ProbePolicy(surface), epsilon);
}

}  // namespace relumbre
