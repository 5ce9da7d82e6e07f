/// How one light is sampled from a receiving point: a ray to trace and what it brings if it
/// arrives.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "relumbre/base/vec3.h"
#include "relumbre/scene/scene.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

/// A point that receives light.
struct Receiver {
  Vec3f origin;  ///< where rays start: the point, moved off its surface by RayScene::epsilon()
  Vec3f normal;  ///< unit; the cosine law is taken about it
};

/// A ray from a receiver towards a light.
struct LightRay {
  Ray ray;
  Rgb irradiance{};       ///< W/m² at unit power, if the ray is not blocked
  bool probe = false;     ///< what the ray brings depends on what it hits: see probed()
  float cosine = 0;       ///< probe only: at the receiver
  float probe_share = 0;  ///< probe only: fraction of the samples that are probes here
  /// A ray that cannot bring anything need not be traced.
  [[nodiscard]] bool worth_tracing() const { return probe || max_component(irradiance) > 0; }
};

/// Samples one light at unit power (color · intensity = 1). The mean of irradiance · visibility
/// over (u, v) uniform in the unit square is the irradiance at the receiver, without bias.
/// Immutable and thread-safe.
class LightSampler {
 public:
  virtual ~LightSampler() = default;
  /// True where one ray from a point says all there is to know: the light has no extent.
  [[nodiscard]] virtual bool has_no_extent() const { return true; }
  [[nodiscard]] virtual LightRay sample(const Receiver& receiver, float u, float v) const = 0;
  /// Irradiance that a probe ray brings, given what it hit.
  [[nodiscard]] virtual Rgb probed(const LightRay& ray, const Hit& hit) const;
};

/// The sampler of any Light. `epsilon`: RayScene::epsilon(). `scene` must outlive the sampler.
/// Point, spot and IES: 1/r² and cosine laws; the spot falls off by a smoothstep of the angle's
/// cosine between the inner and outer cones; an IES profile's 0° plane is turned by rotation_deg
/// from Frame(direction).t. Quad, emitter and sky: light and cosine sampling, combined by the
/// balance heuristic (Veach and Guibas 1995).
/// Throws ValueError naming the light: not finite, an object that does not exist, no profile or
/// sky.
std::unique_ptr<LightSampler> make_light_sampler(const Scene& scene, const Light& light,
                                                 float epsilon);

/// Traces a batch. arriving[i]: irradiance that lights[i] brings, zero if blocked.
/// Returns the number of rays cast.
std::uint64_t trace_light_rays(const RayScene& rays, const LightSampler& sampler,
                               std::span<const LightRay> light_rays, std::span<Rgb> arriving);

}  // namespace relumbre
