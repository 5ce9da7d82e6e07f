#include "relumbre/scene/teapot.h"

#include <cassert>
#include <cmath>
#include <span>
#include <vector>

#include "relumbre/scene/builtin_teapot_patches.h"

namespace relumbre {

namespace {

/// std::lerp is exact at both ends and where a = b, so patches that share control points share
/// the vertices of their common edge, and poles stay points.
Vec3f mix(const Vec3f& a, const Vec3f& b, float t) {
  return {std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t), std::lerp(a.z, b.z, t)};
}

struct CurvePoint {
  Vec3f position, tangent;
};

/// A cubic Bézier curve by de Casteljau's algorithm.
CurvePoint curve(const std::array<Vec3f, 4>& p, float t) {
  const Vec3f ab = mix(p[0], p[1], t), bc = mix(p[1], p[2], t), cd = mix(p[2], p[3], t);
  const Vec3f abc = mix(ab, bc, t), bcd = mix(bc, cd, t);
  return {mix(abc, bcd, t), (bcd - abc) * 3};
}

struct SurfacePoint {
  Vec3f position, ds, dt;
};

SurfacePoint evaluate(const BezierPatch& patch, float s, float t) {
  std::array<Vec3f, 4> across, slopes;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto row = curve({patch[4 * i], patch[4 * i + 1], patch[4 * i + 2], patch[4 * i + 3]}, t);
    across[i] = row.position;
    slopes[i] = row.tangent;
  }
  const CurvePoint down = curve(across, s);
  return {down.position, down.tangent, curve(slopes, s).position};
}

/// The unit normal, at a pole that of a point close by.
Vec3f normal_at(const BezierPatch& patch, float s, float t) {
  const SurfacePoint p = evaluate(patch, s, t);
  const Vec3f n = cross(p.dt, p.ds);
  if (length(n) > 1e-4F) return normalized(n);
  const SurfacePoint near = evaluate(patch, std::lerp(s, 0.5F, 0.01F), std::lerp(t, 0.5F, 0.01F));
  return normalized(cross(near.dt, near.ds));
}

/// An isometry of the teapot: a quarter turn about z, repeated, or the mirror in y.
struct Image {
  int turns = 0;
  bool mirrored = false;
  [[nodiscard]] Vec3f operator()(Vec3f p) const {
    if (mirrored) p.y = -p.y;
    for (int i = 0; i < turns; ++i) p = {p.y, -p.x, p.z};
    return p;
  }
};
constexpr std::array<Image, 4> kQuarters{{{0}, {1}, {2}, {3}}};
constexpr std::array<Image, 2> kHalves{{{0, false}, {0, true}}};

class Potter {
 public:
  Potter(SceneBuilder& builder, float height, int subdivisions)
      : builder_(builder), scale_(height / kHeight), n_(subdivisions) {}

  void add_patches(std::span<const BezierPatch> patches, std::span<const Image> images) {
    for (const BezierPatch& patch : patches)
      for (const Image& image : images) add_patch(patch, image);
  }

  /// Closes the end s = 0 or s = 1 of a tube made of two mirrored halves with a fan.
  void add_cap(const BezierPatch& half, int end) {
    std::vector<Vec3f> loop;
    for (int j = 0; j < n_; ++j) loop.push_back(at(half, end * n_, j));
    for (int j = n_; j > 0; --j) loop.push_back(kHalves[1](at(half, end * n_, j)));
    Vec3f center;
    for (const Vec3f& p : loop) center += p / static_cast<float>(loop.size());
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3f &a = loop[k], &b = loop[(k + 1) % loop.size()];
      if (end == 1)
        builder_.triangle(world(a), world(b), world(center));
      else
        builder_.triangle(world(b), world(a), world(center));
    }
  }

  /// Closes the slit between the lid's edge (its s = 1) and the rim (its s = 0).
  void close_lid(const BezierPatch& lid, const BezierPatch& rim) {
    for (const Image& image : kQuarters)
      for (int j = 0; j < n_; ++j)
        builder_.quad(world(image(at(lid, n_, j))), world(image(at(lid, n_, j + 1))),
                      world(image(at(rim, 0, j + 1))), world(image(at(rim, 0, j))));
  }

 private:
  static constexpr float kHeight = 3.15F;

  [[nodiscard]] float parameter(int i) const {
    return static_cast<float>(i) / static_cast<float>(n_);
  }
  [[nodiscard]] Vec3f at(const BezierPatch& patch, int i, int j) const {
    return evaluate(patch, parameter(i), parameter(j)).position;
  }
  /// z up to y up.
  static Vec3f upright(const Vec3f& p) { return {p.x, p.z, -p.y}; }
  [[nodiscard]] Vec3f world(const Vec3f& p) const { return upright(p) * scale_; }

  void add_patch(const BezierPatch& patch, const Image& image) {
    std::vector<Vec3f> points, normals;
    for (int i = 0; i <= n_; ++i)
      for (int j = 0; j <= n_; ++j) {
        points.push_back(world(image(at(patch, i, j))));
        normals.push_back(upright(image(normal_at(patch, parameter(i), parameter(j)))));
      }
    builder_.surface(points, normals, grid(image.mirrored));
  }

  [[nodiscard]] std::vector<Index3> grid(bool flipped) const {
    std::vector<Index3> triangles;
    const auto row = static_cast<std::uint32_t>(n_ + 1);
    for (std::uint32_t i = 0; i + 1 < row; ++i)
      for (std::uint32_t j = 0; j + 1 < row; ++j) {
        const std::uint32_t a = i * row + j, b = a + 1, c = b + row, d = a + row;
        triangles.push_back(flipped ? Index3{a, c, b} : Index3{a, b, c});
        triangles.push_back(flipped ? Index3{a, d, c} : Index3{a, c, d});
      }
    return triangles;
  }

  SceneBuilder& builder_;
  float scale_;
  int n_;
};

}  // namespace

void add_teapot(SceneBuilder& builder, float height, int subdivisions) {
  assert(height > 0 && subdivisions >= 2);
  Potter potter(builder, height, subdivisions);
  potter.add_patches(kTeapotBody, kQuarters);
  potter.add_patches(kTeapotLid, kQuarters);
  potter.close_lid(kTeapotLid.back(), kTeapotBody.front());
  for (const auto* tube : {&kTeapotHandle, &kTeapotSpout}) {
    potter.add_patches(*tube, kHalves);
    potter.add_cap(tube->front(), 0);
    potter.add_cap(tube->back(), 1);
  }
}

}  // namespace relumbre
