#include "relumbre/render/view_shader.h"

#include <algorithm>
#include <numbers>

#include "relumbre/render/element_points.h"
#include "relumbre/render/primary_hits.h"

namespace relumbre {

ViewShader::ViewShader(const LitScene& in, const ViewConfig& config)
    : scene_(in.scene),
      rays_(in.rays),
      background_(config.background),
      surface_(in,
               config.mode == ViewMode::kDirectPerPixel ? LitSurface::Direct::kGiven
                                                        : LitSurface::Direct::kInterpolated,
               config.smoothing_passes) {
  if (config.mode == ViewMode::kDirectPerPixel) {
    direct_.emplace(in.scene, in.rays, in.lights, config.samples, config.light_samples,
                    config.seed);
  }
  for (const Light& light : in.lights) {
    if (light.type != LightType::kSky || light.power() == Rgb{}) continue;
    skies_.push_back({SkyMap(light), light.power() * std::numbers::pi_v<float>});
  }
}

void ViewShader::shade(std::span<const Hit> hits, std::span<const SampleId> ids,
                       std::span<Rgb> color) const {
  std::fill(color.begin(), color.end(), Rgb{});
  if (direct_) gather_direct(hits, ids, color);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = hits[i];
    color[i] = hit ? surface_.at(hit.triangle, hit.back, hit.u, hit.v, color[i]) : Rgb{};
  }
}

void ViewShader::gather_direct(std::span<const Hit> hits, std::span<const SampleId> ids,
                               std::span<Rgb> direct) const {
  std::vector<PixelSample> samples(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    samples[i].pixel = ids[i].pixel;
    samples[i].index = ids[i].index;
    if (!hits[i]) continue;
    const Surface surface = surface_at(scene_, hits[i]);
    samples[i].receiver = {surface.position + surface.normal * rays_.epsilon(),
                           surface.shading_normal};
    samples[i].lit = true;
  }
  direct_->gather(samples, direct);
}

Rgb ViewShader::background(const Vec3f& direction) const {
  if (skies_.empty()) return background_;
  Rgb sum;
  for (const Sky& sky : skies_) sum += sky.map.radiance(normalized(direction)) * sky.scale;
  return sum;
}

}  // namespace relumbre
