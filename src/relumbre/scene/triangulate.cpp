#include "relumbre/scene/triangulate.h"

#include <cstddef>
#include <cstdint>
#include <numeric>

namespace relumbre {
namespace {

constexpr std::size_t kMostCorners = 256;

/// Area-weighted normal of a closed polygon. Source: Newell's method, Sutherland et al. 1974.
Vec3d polygon_normal(std::span<const Vec3f> corners) {
  Vec3d sum;
  const Vec3d origin(corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(Vec3d(corners[i]) - origin, Vec3d(corners[i + 1]) - origin);
  }
  return sum;
}

/// The corners that are left, as a ring, and the plane they are seen in.
class EarClipper {
 public:
  explicit EarClipper(std::span<const Vec3f> corners)
      : corners_(corners), normal_(polygon_normal(corners)), ring_(corners.size()) {
    std::iota(ring_.begin(), ring_.end(), 0U);
  }

  void clip_all(std::vector<Index3>& triangles) {
    while (ring_.size() > 3) clip(find_ear(), triangles);
    triangles.push_back({ring_[0], ring_[1], ring_[2]});
  }

 private:
  [[nodiscard]] std::uint32_t at(std::size_t i) const { return ring_[i % ring_.size()]; }

  /// Twice the signed area of a triangle seen along the normal, times the normal's length.
  [[nodiscard]] double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3d origin(corners_[a]);
    return dot(normal_, cross(Vec3d(corners_[b]) - origin, Vec3d(corners_[c]) - origin));
  }

  /// Place in the ring of an ear's tip; of the first corner where there is none (no simple
  /// polygon).
  [[nodiscard]] std::size_t find_ear() const {
    for (std::size_t i = 1; i <= ring_.size(); ++i) {
      if (is_ear(at(i - 1), at(i), at(i + 1))) return i % ring_.size();
    }
    return 1;
  }

  [[nodiscard]] bool is_ear(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if (!(turn(a, b, c) > 0)) return false;
    for (const std::uint32_t p : ring_) {
      if (p == a || p == b || p == c || is_same_point(p, a, b, c)) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  /// Polygons with a hole pass along a seam twice; its points do not block its own ears.
  [[nodiscard]] bool is_same_point(std::uint32_t p, std::uint32_t a, std::uint32_t b,
                                   std::uint32_t c) const {
    return corners_[p] == corners_[a] || corners_[p] == corners_[b] || corners_[p] == corners_[c];
  }

  void clip(std::size_t tip, std::vector<Index3>& triangles) {
    triangles.push_back({at(tip + ring_.size() - 1), at(tip), at(tip + 1)});
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(tip));
  }

  std::span<const Vec3f> corners_;
  Vec3d normal_;
  std::vector<std::uint32_t> ring_;
};

void fan(std::size_t corners, std::vector<Index3>& triangles) {
  for (std::uint32_t i = 1; i + 1 < corners; ++i) triangles.push_back({0, i, i + 1});
}

/// A quadrilateral is cut from corner 0 unless that leaves it at corner 1 or 3, where it is
/// concave.
void cut_quadrilateral(std::span<const Vec3f> q, std::vector<Index3>& triangles) {
  const Vec3d a(q[0]), b(q[1]), c(q[2]), d(q[3]);
  const bool from_first = !(dot(cross(b - a, c - a), cross(c - a, d - a)) < 0);
  if (from_first) {
    triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  } else {
    triangles.insert(triangles.end(), {{0, 1, 3}, {1, 2, 3}});
  }
}

}  // namespace

void triangulate_polygon(std::span<const Vec3f> corners, std::vector<Index3>& triangles) {
  if (corners.size() < 3) return;
  if (corners.size() == 3 || corners.size() > kMostCorners) {
    fan(corners.size(), triangles);
  } else if (corners.size() == 4) {
    cut_quadrilateral(corners, triangles);
  } else {
    EarClipper(corners).clip_all(triangles);
  }
}

}  // namespace relumbre
