/// Pictures through a lens of finite size: the reference for depth of field.
#pragma once

#include "relumbre/image/thin_lens.h"
#include "relumbre/render/view.h"

namespace relumbre {

struct LensViewConfig {
  /// `samples`: rays a pixel, each through its own point of the lens, up to 2^16. One layer only.
  ViewConfig view{.samples = 256};
  ThinLens lens;
  Aperture aperture;
};

/// What render_view draws, seen through a thin lens: the camera frames the picture as it does
/// there, and a point at planar depth z becomes a disc (or a polygon) of
/// lens.coc_diameter_pixels(z, width) pixels in diameter. Light is the same function of a hit as in
/// render_view, and the pixel filter is the same tent. Channels as there; R, G, B and A through the
/// lens, all others those of the pinhole camera.
///
/// Samples are low-discrepancy over lens and pixel (see LensSamples). In mode kGouraud the cost is
/// the rays' alone. In mode kDirectPerPixel every one of them shoots at least one shadow ray at
/// every light, whatever light_samples says.
///
/// Deterministic for any number of threads. Throws what render_view throws, and ValueError for a
/// lens or aperture that is none.
Image render_lens_view(const LitScene& lit_scene, const Camera& camera,
                       const LensViewConfig& config = {}, Progress& progress = no_progress());

/// Planar depth along the rays through the pixels' centres, as channel Z of render_view: what one
/// focuses on. width · height; inf where nothing is hit. Throws ValueError as render_view does.
std::vector<float> pinhole_depth(const Scene& scene, const RayScene& rays, const Camera& camera,
                                 std::size_t width, std::size_t height);

}  // namespace relumbre
