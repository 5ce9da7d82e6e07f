/// The light that leaves a lit scene's surface at any point: what pictures and voxels share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/render/shading.h"
#include "relumbre/render/view.h"

namespace relumbre {

/// Immutable and thread-safe.
class LitSurface {
 public:
  enum class Direct { kInterpolated, kGiven };

  /// Interpolates irradiance between elements, what has bounced smoothed `smoothing_passes` times.
  /// The scene, tessellation and display mesh of `lit_scene` must outlive this. Throws ShapeError
  /// where sizes disagree.
  LitSurface(const LitScene& lit_scene, Direct direct, std::size_t smoothing_passes);

  /// Radiosity in W/m² at barycentrics (u, v) on one side of a source triangle: emission, and
  /// reflectance (textures and all) times irradiance. `direct` is the irradiance straight from
  /// lights, if it is given.
  [[nodiscard]] Rgb at(std::uint32_t triangle, bool back, float u, float v,
                       const Rgb& direct = {}) const;

 private:
  const Scene& scene_;
  std::vector<Rgb> powers_;
  DisplayField irradiance_;
};

}  // namespace relumbre
