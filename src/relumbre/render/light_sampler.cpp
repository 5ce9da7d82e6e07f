#include "relumbre/render/light_sampler.h"

#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/render/area_light.h"
#include "relumbre/render/sky_light.h"

namespace relumbre {

Rgb LightSampler::probed(const LightRay&, const Hit&) const { return {}; }

namespace {

constexpr float kDegree = std::numbers::pi_v<float> / 180;

/// A light at a point: 1/r² times whatever its profile says of a direction.
class PointSampler : public LightSampler {
 public:
  PointSampler(const Vec3f& position, float epsilon) : position_(position), epsilon_(epsilon) {}

  LightRay sample(const Receiver& receiver, float, float) const final {
    const Vec3f to_light = position_ - receiver.origin;
    const float distance = length(to_light);
    // The ray stops short of the light, so that a lamp that lies in a surface still shines.
    if (!(distance > epsilon_)) return {};
    const Vec3f direction = to_light / distance;
    const float cosine = dot(receiver.normal, direction);
    if (cosine <= 0) return {};
    const float irradiance = profile(-direction) * cosine / (distance * distance);
    return {.ray = {receiver.origin, 0, direction, distance * (1 - 1e-5F) - epsilon_},
            .irradiance = Rgb(irradiance)};
  }

 private:
  /// W/sr towards a unit direction, at unit power.
  [[nodiscard]] virtual float profile(const Vec3f&) const { return 1; }

  Vec3f position_;
  float epsilon_;
};

class SpotSampler final : public PointSampler {
 public:
  SpotSampler(const Light& light, float epsilon)
      : PointSampler(light.position, epsilon),
        axis_(normalized(light.direction)),
        cos_inner_(std::cos(light.inner_deg * kDegree)),
        cos_outer_(std::cos(light.outer_deg * kDegree)) {}

 private:
  [[nodiscard]] float profile(const Vec3f& direction) const override {
    const float cosine = dot(direction, axis_);
    if (cosine >= cos_inner_) return 1;
    if (cosine <= cos_outer_) return 0;
    const float t = (cosine - cos_outer_) / (cos_inner_ - cos_outer_);
    return t * t * (3 - 2 * t);
  }

  Vec3f axis_;
  float cos_inner_, cos_outer_;
};

class IesSampler final : public PointSampler {
 public:
  IesSampler(const Light& light, float epsilon)
      : PointSampler(light.position, epsilon),
        profile_(light.ies),
        frame_(normalized(light.direction)) {
    const float angle = light.rotation_deg * kDegree;
    const Vec3f t = frame_.t * std::cos(angle) + frame_.b * std::sin(angle);
    frame_.b = frame_.b * std::cos(angle) - frame_.t * std::sin(angle);
    frame_.t = t;
  }

 private:
  [[nodiscard]] float profile(const Vec3f& d) const override {
    return profile_->relative({dot(d, frame_.t), dot(d, frame_.b), dot(d, frame_.n)});
  }

  std::shared_ptr<const IesProfile> profile_;
  Frame frame_;
};

class DirectionalSampler final : public LightSampler {
 public:
  explicit DirectionalSampler(const Vec3f& direction) : to_light_(-normalized(direction)) {}
  LightRay sample(const Receiver& receiver, float, float) const override {
    const float cosine = dot(receiver.normal, to_light_);
    if (cosine <= 0) return {};
    return {.ray = {.origin = receiver.origin, .direction = to_light_}, .irradiance = Rgb(cosine)};
  }

 private:
  Vec3f to_light_;
};

[[noreturn]] void refuse(const Light& light, std::string_view reason) {
  throw ValueError(fmt::format("light '{}' {}", light.name, reason));
}

bool uses_direction(LightType type) {
  return type == LightType::kSpot || type == LightType::kDirectional || type == LightType::kIes;
}

void check(const Light& light) {
  const float angles = light.inner_deg + light.outer_deg + light.rotation_deg;
  if (!is_finite(light.position) || !is_finite(light.direction) || !is_finite(light.edge1) ||
      !is_finite(light.edge2) || !std::isfinite(angles)) {
    refuse(light, "has a position, direction, edge or angle that is not finite");
  }
  if (uses_direction(light.type) && !(length(light.direction) > 0)) {
    refuse(light, "has a direction of length 0");
  }
  if (light.type == LightType::kIes && !light.ies) refuse(light, "has no IES profile");
}

}  // namespace

std::unique_ptr<LightSampler> make_light_sampler(const Scene& scene, const Light& light,
                                                 float epsilon) {
  check(light);
  switch (light.type) {
    case LightType::kPoint:
      return std::make_unique<PointSampler>(light.position, epsilon);
    case LightType::kSpot:
      return std::make_unique<SpotSampler>(light, epsilon);
    case LightType::kDirectional:
      return std::make_unique<DirectionalSampler>(light.direction);
    case LightType::kIes:
      return std::make_unique<IesSampler>(light, epsilon);
    case LightType::kQuad:
      return make_quad_sampler(light, epsilon);
    case LightType::kEmitter:
      return make_emitter_sampler(scene, light, epsilon);
    case LightType::kSky:
      return make_sky_sampler(light);
  }
  refuse(light, "is of a type that is not known");
}

std::uint64_t trace_light_rays(const RayScene& rays, const LightSampler& sampler,
                               std::span<const LightRay> light_rays, std::span<Rgb> arriving) {
  // Occlusion rays and probes go through different queries: sort them apart, keeping the order.
  std::vector<Ray> shadow, probes;
  for (const LightRay& r : light_rays) {
    if (r.worth_tracing()) (r.probe ? probes : shadow).push_back(r.ray);
  }
  std::vector<std::uint8_t> blocked(shadow.size());
  std::vector<Hit> hits(probes.size());
  rays.occluded(shadow, blocked);
  rays.closest(probes, hits);

  std::size_t next_shadow = 0, next_probe = 0;
  for (std::size_t i = 0; i < light_rays.size(); ++i) {
    const LightRay& r = light_rays[i];
    if (!r.worth_tracing()) {
      arriving[i] = {};
    } else if (r.probe) {
      arriving[i] = sampler.probed(r, hits[next_probe++]);
    } else {
      arriving[i] = blocked[next_shadow++] != 0 ? Rgb{} : r.irradiance;
    }
  }
  return shadow.size() + probes.size();
}

}  // namespace relumbre
