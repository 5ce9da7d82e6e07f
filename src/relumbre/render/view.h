/// Pictures of a lit scene.
#pragma once

#include <cstdint>
#include <span>

#include "relumbre/base/progress.h"
#include "relumbre/geometry/display.h"
#include "relumbre/image/image.h"
#include "relumbre/render/relight.h"
#include "relumbre/scene/camera.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

enum class ViewMode {
  kGouraud,         ///< all light interpolated between elements
  kDirectPerPixel,  ///< direct light by shadow rays at every pixel, the rest interpolated
};

struct ViewConfig {
  std::size_t width = 1280, height = 720;
  std::uint32_t samples = 16;  ///< rays a pixel, with a tent filter; 1: through its centre
  ViewMode mode = ViewMode::kGouraud;
  std::uint32_t light_samples = 16;  ///< shadow rays a pixel and light with a surface, at least
  Rgb background{};                  ///< where nothing is hit and no sky is on; W/m², as pixels
  std::size_t smoothing_passes = 2;  ///< of the indirect light, against noise: see smoothed()
  std::uint64_t seed = 1;
  std::uint32_t layers = 1;         ///< 2: also what lies behind the first visible surface
  float layer_separation = 0.002F;  ///< how much deeper that must be, as a fraction of its depth
};

/// A scene and the light in it.
struct LitScene {
  const Scene& scene;
  const Tessellation& tessellation;
  const DisplayMesh& display;  ///< conforming_mesh(tessellation, ...)
  const RayScene& rays;
  std::span<const Rgb> reflectance;  ///< n, that `lit` was computed with
  std::span<const Light> lights;     ///< that `lit` was computed with
  const RelitResult& lit;
};

/// The scene as a camera sees it, with channels
///   R G B                 radiosity in W/m²: π times radiance; a sky likewise
///   A                     fraction of the pixel's samples that hit a surface
///   Z                     planar depth in metres, inf where nothing is hit
///   N.X N.Y N.Z           world normal of the surface, facing the camera
///   albedo.R .G .B        diffuse reflectance
/// The last three from the ray through the pixel's centre. With two layers also
///   layer1.R .G .B .A .Z  the same picture if what is seen first were not there: see trace_behind.
///                         A is 0 and Z inf where nothing is behind; Z is 0 where it is not known.
///                         Each pixel shows one surface: that of its depth
/// Irradiance is interpolated and then multiplied by the reflectance at the sample, so textures
/// stay sharp. Emissive surfaces show
/// their emission. Backs of one-sided surfaces are not seen. Deterministic for any number of
/// threads. Throws ValueError for a camera or config out of range (more than 2^28 pixels, no
/// samples, more than 2^14, a number of layers other than 1 and 2), ShapeError where sizes
/// disagree, Cancelled.
Image render_view(const LitScene& lit_scene, const Camera& camera, const ViewConfig& config = {},
                  Progress& progress = no_progress());

}  // namespace relumbre
