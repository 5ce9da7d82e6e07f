/// Primary rays of a pinhole camera.
#pragma once

#include <cstddef>

#include "relumbre/scene/camera.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

/// Rays through an image of width × height square pixels. Pixel (0, 0) is at the top left, and
/// (x, y) in [0, width] × [0, height] are continuous: pixel centres lie at halves.
/// Directions are scaled to advance 1 m along the viewing axis, so that a hit's t is the planar
/// depth.
class CameraRays {
 public:
  /// Where `up` runs along the viewing axis, any perpendicular is taken. Throws ValueError naming
  /// the camera: eye and target coincide or are not finite, vfov_deg outside (0, 180), a side of 0.
  CameraRays(const Camera& camera, std::size_t width, std::size_t height);

  [[nodiscard]] Ray through(float x, float y) const;
  /// The ray to the same point of the plane at depth `focus_distance`, from a point of the lens
  /// that is lens.x metres to the right of the eye and lens.y above it. Its t is the planar depth,
  /// too.
  [[nodiscard]] Ray through_lens(float x, float y, const Vec2f& lens, float focus_distance) const;
  /// Unit vector from the eye along the viewing axis.
  [[nodiscard]] const Vec3f& forward() const { return forward_; }
  /// Pixels that a metre at a depth of one metre takes.
  [[nodiscard]] double pixels_per_tangent() const { return pixels_per_tangent_; }

 private:
  Vec3f eye_, forward_, right_, up_;
  double pixels_per_tangent_;
  Vec3f corner_;           ///< direction through (0, 0)
  Vec3f step_x_, step_y_;  ///< its change over one pixel
};

}  // namespace relumbre
