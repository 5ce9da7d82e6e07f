/// The light that leaves what a camera sees: what all views of a lit scene share.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "relumbre/render/lit_surface.h"
#include "relumbre/render/pixel_light.h"
#include "relumbre/render/sky_light.h"
#include "relumbre/render/view.h"

namespace relumbre {

/// Which of a picture's samples a hit belongs to.
struct SampleId {
  std::size_t pixel = 0;
  std::uint32_t index = 0;  ///< among the pixel's samples
};

/// Immutable and thread-safe.
class ViewShader {
 public:
  /// Interpolates the light of the scene as config.mode says. What `lit_scene` refers to must
  /// outlive this. Throws ShapeError where sizes disagree.
  ViewShader(const LitScene& lit_scene, const ViewConfig& config);

  /// Radiosity in W/m² at hits[i] of sample ids[i]: emission, and irradiance times reflectance. 0
  /// where nothing is hit. In mode kDirectPerPixel this shoots shadow rays.
  void shade(std::span<const Hit> hits, std::span<const SampleId> ids, std::span<Rgb> color) const;

  /// What is seen along a direction where nothing is hit.
  [[nodiscard]] Rgb background(const Vec3f& direction) const;

 private:
  struct Sky {
    SkyMap map;
    Rgb scale;
  };
  void gather_direct(std::span<const Hit> hits, std::span<const SampleId> ids,
                     std::span<Rgb> direct) const;

  const Scene& scene_;
  const RayScene& rays_;
  Rgb background_;
  LitSurface surface_;
  std::optional<PixelLight> direct_;
  std::vector<Sky> skies_;
};

}  // namespace relumbre
