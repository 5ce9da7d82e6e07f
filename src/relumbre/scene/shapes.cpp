#include "relumbre/scene/shapes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

namespace relumbre {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Two triangles for every cell of a grid of rows × columns points; columns wrap if `closed`.
std::vector<Index3> grid_triangles(std::uint32_t rows, std::uint32_t columns, bool closed) {
  std::vector<Index3> triangles;
  const std::uint32_t cells = closed ? columns : columns - 1;
  for (std::uint32_t r = 0; r + 1 < rows; ++r)
    for (std::uint32_t c = 0; c < cells; ++c) {
      const std::uint32_t next = (c + 1) % columns;
      const std::uint32_t i = r * columns + c, j = r * columns + next;
      triangles.push_back({i, j, j + columns});
      triangles.push_back({i, j + columns, i + columns});
    }
  return triangles;
}

/// One side of a rounded box: its local axes and how the sample steps run along each.
struct RoundedSide {
  std::size_t normal_axis, u_axis, v_axis;
  float sign;
};

/// Steps across a side: first those about the low edge, then those about the high one. `slope` is
/// the tangent of the angle from the side's normal.
struct RoundedStep {
  float slope;
  bool high;
};

std::vector<RoundedStep> rounded_steps(int segments) {
  std::vector<RoundedStep> steps;
  for (int i = -segments; i <= 0; ++i)
    steps.push_back({i == -segments
                         ? -1.0F
                         : std::tan(kPi / 4 * static_cast<float>(i) / static_cast<float>(segments)),
                     false});
  for (std::size_t i = steps.size(); i-- > 0;) steps.push_back({-steps[i].slope, true});
  return steps;
}

void add_rounded_side(SceneBuilder& builder, const Vec3f& inner_low, const Vec3f& inner_high,
                      float radius, const RoundedSide& side, std::span<const RoundedStep> steps) {
  std::vector<Vec3f> points, normals;
  for (const RoundedStep& v : steps)
    for (const RoundedStep& u : steps) {
      Vec3f normal, corner;
      normal[side.normal_axis] = side.sign;
      normal[side.u_axis] = u.slope;
      normal[side.v_axis] = v.slope;
      corner[side.normal_axis] = (side.sign > 0 ? inner_high : inner_low)[side.normal_axis];
      corner[side.u_axis] = (u.high ? inner_high : inner_low)[side.u_axis];
      corner[side.v_axis] = (v.high ? inner_high : inner_low)[side.v_axis];
      normals.push_back(normalized(normal));
      points.push_back(corner + normals.back() * radius);
    }
  const auto count = static_cast<std::uint32_t>(steps.size());
  builder.surface(points, normals, grid_triangles(count, count, false));
}

/// Unit normal, in (radius, height), on the right of the way from a to b.
Vec2f profile_normal(Vec2f a, Vec2f b) {
  const float dr = b.x - a.x, dh = b.y - a.y, l = std::hypot(dr, dh);
  assert(l > 0);
  return {dh / l, -dr / l};
}

/// The mean of two unit normals, or the first where they differ by more than 40 degrees.
Vec2f soften(Vec2f own, Vec2f other) {
  if (own.x * other.x + own.y * other.y < std::cos(kPi * 40 / 180)) return own;
  const Vec2f sum = own + other;
  return sum * (1 / std::hypot(sum.x, sum.y));
}

void add_ring(std::vector<Vec3f>& points, std::vector<Vec3f>& normals, Vec2f at, Vec2f normal,
              int segments) {
  for (int i = 0; i < segments; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(segments);
    const float c = std::cos(angle), s = -std::sin(angle);
    points.push_back({at.x * c, at.y, at.x * s});
    normals.push_back({normal.x * c, normal.y, normal.x * s});
  }
}

}  // namespace

void add_box(SceneBuilder& builder, const Vec3f& lower, const Vec3f& upper, unsigned faces) {
  const auto [x0, y0, z0] = lower;
  const auto [x1, y1, z1] = upper;
  if (faces & kLeftFace) builder.quad({x0, y0, z0}, {x0, y0, z1}, {x0, y1, z1}, {x0, y1, z0});
  if (faces & kRightFace) builder.quad({x1, y0, z1}, {x1, y0, z0}, {x1, y1, z0}, {x1, y1, z1});
  if (faces & kBottomFace) builder.quad({x0, y0, z0}, {x1, y0, z0}, {x1, y0, z1}, {x0, y0, z1});
  if (faces & kTopFace) builder.quad({x0, y1, z1}, {x1, y1, z1}, {x1, y1, z0}, {x0, y1, z0});
  if (faces & kBackFace) builder.quad({x1, y0, z0}, {x0, y0, z0}, {x0, y1, z0}, {x1, y1, z0});
  if (faces & kFrontFace) builder.quad({x0, y0, z1}, {x1, y0, z1}, {x1, y1, z1}, {x0, y1, z1});
}

void add_rounded_box(SceneBuilder& builder, const Vec3f& lower, const Vec3f& upper, float radius,
                     int segments) {
  const Vec3f low = lower + Vec3f(radius), high = upper - Vec3f(radius);
  const std::vector<RoundedStep> steps = rounded_steps(segments);
  // u × v is the outward normal of each side.
  for (const RoundedSide& side : {RoundedSide{0, 1, 2, 1},
                                  {0, 2, 1, -1},
                                  {1, 2, 0, 1},
                                  {1, 0, 2, -1},
                                  {2, 0, 1, 1},
                                  {2, 1, 0, -1}})
    add_rounded_side(builder, low, high, radius, side, steps);
}

void add_revolved(SceneBuilder& builder, std::span<const Vec2f> profile, int segments) {
  std::vector<Vec2f> normal;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
    normal.push_back(profile_normal(profile[i], profile[i + 1]));
  const auto grid = grid_triangles(2, static_cast<std::uint32_t>(segments), true);
  for (std::size_t i = 0; i < normal.size(); ++i) {
    const Vec2f first = i == 0 ? normal[i] : soften(normal[i], normal[i - 1]);
    const Vec2f last = i + 1 == normal.size() ? normal[i] : soften(normal[i], normal[i + 1]);
    std::vector<Vec3f> points, normals;
    add_ring(points, normals, profile[i], first, segments);
    add_ring(points, normals, profile[i + 1], last, segments);
    builder.surface(points, normals, grid);
  }
}

void add_sphere(SceneBuilder& builder, const Vec3f& center, float radius, int segments) {
  const int rows = segments / 2;
  std::vector<Vec2f> profile;
  for (int i = 0; i <= rows; ++i) {
    const float angle = kPi * static_cast<float>(i) / static_cast<float>(rows);
    const bool pole = i == 0 || i == rows;
    profile.push_back({pole ? 0 : radius * std::sin(angle), -radius * std::cos(angle)});
  }
  const ScopedPlacement moved(builder, {center});
  add_revolved(builder, profile, segments);
}

void add_bar(SceneBuilder& builder, const Vec3f& a, const Vec3f& b, float radius_a, float radius_b,
             int segments) {
  const float l = length(b - a);
  const ScopedPlacement moved(builder, along(a, (b - a) / l));
  add_revolved(builder, std::array<Vec2f, 4>{{{0, 0}, {radius_a, 0}, {radius_b, l}, {0, l}}},
               segments);
}

void add_leg(SceneBuilder& builder, const Vec3f& bottom, const Vec3f& top, float radius_bottom,
             float radius_top, int segments) {
  std::vector<Vec3f> points, normals;
  add_ring(points, normals, {radius_bottom, bottom.y}, {1, 0}, segments);
  add_ring(points, normals, {radius_top, top.y}, {1, 0}, segments);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f& center = i < points.size() / 2 ? bottom : top;
    points[i] += Vec3f(center.x, 0, center.z);
  }
  builder.surface(points, normals, grid_triangles(2, static_cast<std::uint32_t>(segments), true));
}

void add_panel(SceneBuilder& builder, const Plane& plane, const Rect& rect,
               std::span<const Rect> holes, float height) {
  std::vector<float> us{rect.u0, rect.u1}, vs{rect.v0, rect.v1};
  for (const Rect& hole : holes) {
    us.insert(us.end(), {hole.u0, hole.u1});
    vs.insert(vs.end(), {hole.v0, hole.v1});
  }
  for (auto* cuts : {&us, &vs}) {
    std::sort(cuts->begin(), cuts->end());
    cuts->erase(std::unique(cuts->begin(), cuts->end()), cuts->end());
  }
  const auto open = [&](float u, float v) {
    return std::any_of(holes.begin(), holes.end(), [&](const Rect& h) {
      return u >= h.u0 && u < h.u1 && v >= h.v0 && v < h.v1;
    });
  };
  for (std::size_t i = 0; i + 1 < us.size(); ++i)
    for (std::size_t j = 0; j + 1 < vs.size(); ++j)
      if (!open(us[i], vs[j]))
        builder.quad(plane.at(us[i], vs[j], height), plane.at(us[i + 1], vs[j], height),
                     plane.at(us[i + 1], vs[j + 1], height), plane.at(us[i], vs[j + 1], height));
}

namespace {

/// The four sides of a rectangle between two heights, facing out of it (or into it).
void add_sides(SceneBuilder& builder, const Plane& plane, const Rect& r, float bottom, float top,
               bool outward) {
  const std::array<Vec2f, 4> corners{{{r.u0, r.v0}, {r.u1, r.v0}, {r.u1, r.v1}, {r.u0, r.v1}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec2f a = corners[outward ? i : (i + 1) % 4], b = corners[outward ? (i + 1) % 4 : i];
    builder.quad(plane.at(a.x, a.y, bottom), plane.at(b.x, b.y, bottom), plane.at(b.x, b.y, top),
                 plane.at(a.x, a.y, top));
  }
}

}  // namespace

void add_frame(SceneBuilder& builder, const Plane& plane, const FrameShape& frame) {
  add_panel(builder, plane, frame.outer, std::array{frame.inner}, frame.top);
  add_sides(builder, plane, frame.inner, frame.bottom, frame.top, false);
  if (frame.outer_sides) add_sides(builder, plane, frame.outer, frame.bottom, frame.top, true);
  if (!frame.back) return;
  const auto mirrored = [](const Rect& r) { return Rect{r.v0, r.u0, r.v1, r.u1}; };
  add_panel(builder, {plane.origin, plane.v, plane.u}, mirrored(frame.outer),
            std::array{mirrored(frame.inner)}, -frame.bottom);
}

void add_slab(SceneBuilder& builder, const Plane& plane, const Rect& rect, float bottom,
              float top) {
  add_panel(builder, plane, rect, {}, top);
  add_sides(builder, plane, rect, bottom, top, true);
}

}  // namespace relumbre
