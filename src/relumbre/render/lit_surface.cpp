#include "relumbre/render/lit_surface.h"

#include <utility>

namespace relumbre {

namespace {

std::vector<Rgb> interpolated(const LitScene& in, LitSurface::Direct direct,
                              std::size_t smoothing_passes) {
  ShadingInput shading =
      shading_input(in.tessellation, in.display, in.lit, in.reflectance, smoothing_passes);
  if (direct == LitSurface::Direct::kGiven) return std::move(shading.indirect);
  for (std::size_t i = 0; i < shading.indirect.size(); ++i)
    shading.indirect[i] += shading.direct[i];
  return std::move(shading.indirect);
}

}  // namespace

LitSurface::LitSurface(const LitScene& in, Direct direct, std::size_t smoothing_passes)
    : scene_(in.scene),
      powers_(object_powers(in.scene, in.lights)),
      irradiance_(in.tessellation, in.display, interpolated(in, direct, smoothing_passes)) {}

Rgb LitSurface::at(std::uint32_t triangle, bool back, float u, float v, const Rgb& direct) const {
  const Rgb irradiance = irradiance_.at(triangle, back, u, v) + direct;
  const Rgb emission =
      scene_.material_of(triangle).emission * powers_[scene_.mesh.object[triangle]];
  return emission + scene_.reflectance(triangle, u, v) * irradiance;
}

}  // namespace relumbre
