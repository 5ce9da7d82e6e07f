/// The solids that the built-in scenes are made of. All fronts face outward; metres.
#pragma once

#include <span>

#include "relumbre/scene/scene_builder.h"

namespace relumbre {

/// Faces of an axis-aligned box; those that touch something else are better left out.
enum BoxFace : unsigned {
  kLeftFace = 1,    ///< -x
  kRightFace = 2,   ///< +x
  kBottomFace = 4,  ///< -y
  kTopFace = 8,     ///< +y
  kBackFace = 16,   ///< -z
  kFrontFace = 32,  ///< +z
  kAllFaces = 63,
};

/// Two triangles a face.
void add_box(SceneBuilder& builder, const Vec3f& lower, const Vec3f& upper,
             unsigned faces = kAllFaces);

/// A closed box with edges and corners rounded to `radius` (at most half the shortest side), each
/// quarter turn in 2·segments steps: 12·(2·segments + 1)² triangles.
void add_rounded_box(SceneBuilder& builder, const Vec3f& lower, const Vec3f& upper, float radius,
                     int segments = 2);

/// The surface that a polyline of (radius, height) sweeps about the y axis. Its front is on the
/// right of the direction of travel: a profile that starts on the axis, goes out, up and back to
/// the axis is a solid. Smooth except where the profile turns by more than 40 degrees.
void add_revolved(SceneBuilder& builder, std::span<const Vec2f> profile, int segments);

void add_sphere(SceneBuilder& builder, const Vec3f& center, float radius, int segments);

/// A round bar from a to b, tapering from radius_a to radius_b, with end caps.
void add_bar(SceneBuilder& builder, const Vec3f& a, const Vec3f& b, float radius_a, float radius_b,
             int segments);

/// A round leg between two horizontal rings, without caps: it stands on one surface and carries
/// another, however it is splayed. bottom.y < top.y.
void add_leg(SceneBuilder& builder, const Vec3f& bottom, const Vec3f& top, float radius_bottom,
             float radius_top, int segments = 16);

/// A plane with axes u and v; its front looks along u × v.
struct Plane {
  Vec3f origin, u, v;
  [[nodiscard]] Vec3f at(float a, float b, float height = 0) const {
    return origin + u * a + v * b + cross(u, v) * height;
  }
};
struct Rect {
  float u0, v0, u1, v1;
};

/// A rectangle of a plane, raised by `height`, minus holes, without T-junctions.
void add_panel(SceneBuilder& builder, const Plane& plane, const Rect& rect,
               std::span<const Rect> holes = {}, float height = 0);

/// A rectangular frame that rises from height `bottom` to `top` over a plane.
struct FrameShape {
  Rect outer, inner;
  float bottom = 0, top = 0.02F;
  bool outer_sides = true;  ///< false where it is let into a wall
  bool back = false;        ///< a face at `bottom` too
};
void add_frame(SceneBuilder& builder, const Plane& plane, const FrameShape& frame);

/// A rectangle raised over a plane, with its four sides.
void add_slab(SceneBuilder& builder, const Plane& plane, const Rect& rect, float bottom, float top);

}  // namespace relumbre
