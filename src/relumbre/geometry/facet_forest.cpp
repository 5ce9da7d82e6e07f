#include "relumbre/geometry/facet_forest.h"

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

constexpr std::size_t kMaxSides = std::size_t{1} << 28;

void check(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  if (count == 0) throw ValueError("mesh: it has no triangles");
  if (2 * count > kMaxSides) {
    throw ValueError(fmt::format("mesh: {} triangles, but the limit is {}", count, kMaxSides / 2));
  }
  if (!mesh.two_sided.empty() && mesh.two_sided.size() != count) {
    throw ShapeError(fmt::format("mesh: two_sided has {} entries for {} triangles",
                                 mesh.two_sided.size(), count));
  }
}

void check_indices(const TriangleMesh& mesh, std::size_t triangle) {
  for (const std::uint32_t vertex : mesh.triangles[triangle]) {
    if (vertex >= mesh.positions.size()) {
      throw ValueError(fmt::format("mesh: triangle {} uses vertex {} of {}", triangle, vertex,
                                   mesh.positions.size()));
    }
  }
}

Vec3d doubled_area_vector(const TriangleMesh& mesh, std::size_t triangle) {
  const Vec3d a(mesh.corner(triangle, 0));
  return cross(Vec3d(mesh.corner(triangle, 1)) - a, Vec3d(mesh.corner(triangle, 2)) - a);
}

}  // namespace

FacetForest::FacetForest(const TriangleMesh& mesh) : points_(mesh.positions.size()) {
  check(mesh);
  normals_.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    check_indices(mesh, t);
    const Vec3d doubled = doubled_area_vector(mesh, t);
    const double area = length(doubled) / 2;
    // Below float's normal range an element could not carry its area. NaN fails both comparisons.
    if (!(area >= std::numeric_limits<float>::min() && area <= std::numeric_limits<float>::max())) {
      throw ValueError(fmt::format("mesh: triangle {} has area {}: clean the mesh first", t, area));
    }
    normals_.emplace_back(doubled / (2 * area));
    const Index3 corners{points_.insert(mesh.corner(t, 0)), points_.insert(mesh.corner(t, 1)),
                         points_.insert(mesh.corner(t, 2))};
    add_side(corners, t, 0, area);
    if (!mesh.two_sided.empty() && mesh.two_sided[t] != 0) {
      add_side({corners[0], corners[2], corners[1]}, t, 1, area);
    }
  }
  sides_ = static_cast<std::uint32_t>(cells_.size());
}

void FacetForest::add_side(const Index3& corners, std::size_t triangle, std::uint32_t back,
                           double area) {
  cells_.push_back({corners, static_cast<std::uint32_t>(2 * triangle) + back, 0, area});
}

std::optional<std::uint32_t> FacetForest::cut(std::uint32_t cell) {
  const auto [a, b, c] = cells_[cell].corners;
  const Vec3f pa = points_[a], pb = points_[b], pc = points_[c];
  const Vec3f mid_bc = midpoint(pb, pc), mid_ca = midpoint(pc, pa), mid_ab = midpoint(pa, pb);
  if (mid_bc == pb || mid_bc == pc || mid_ca == pc || mid_ca == pa || mid_ab == pa ||
      mid_ab == pb || mid_bc == mid_ca || mid_ca == mid_ab || mid_ab == mid_bc) {
    return std::nullopt;
  }
  const std::uint32_t bc = points_.insert(mid_bc);
  const std::uint32_t ca = points_.insert(mid_ca);
  const std::uint32_t ab = points_.insert(mid_ab);
  const auto first = static_cast<std::uint32_t>(cells_.size());
  const std::uint32_t side = cells_[cell].side;
  const double quarter = cells_[cell].area / 4;
  cells_[cell].children = first;
  cells_.push_back({{a, ab, ca}, side, 0, quarter});
  cells_.push_back({{ab, b, bc}, side, 0, quarter});
  cells_.push_back({{ca, bc, c}, side, 0, quarter});
  cells_.push_back({{bc, ca, ab}, side, 0, quarter});
  return first;
}

void FacetForest::append_leaves(std::uint32_t cell, std::vector<std::uint32_t>& leaves) const {
  const std::uint32_t first = cells_[cell].children;
  if (first == 0) return leaves.push_back(cell);
  for (std::uint32_t child = first; child < first + 4; ++child) append_leaves(child, leaves);
}

Vec3f FacetForest::normal(std::uint32_t cell) const {
  const std::uint32_t side = cells_[cell].side;
  return side % 2 == 0 ? normals_[side / 2] : -normals_[side / 2];
}

Vec3d FacetForest::centroid(std::uint32_t cell) const {
  const auto [a, b, c] = cells_[cell].corners;
  return (Vec3d(points_[a]) + Vec3d(points_[b]) + Vec3d(points_[c])) / 3;
}

double FacetForest::spread(std::uint32_t cell) const {
  const auto [a, b, c] = cells_[cell].corners;
  const Vec3d ab = Vec3d(points_[b]) - Vec3d(points_[a]);
  const Vec3d bc = Vec3d(points_[c]) - Vec3d(points_[b]);
  const Vec3d ca = Vec3d(points_[a]) - Vec3d(points_[c]);
  return (dot(ab, ab) + dot(bc, bc) + dot(ca, ca)) / 36;
}

double FacetForest::area() const {
  double sum = 0;
  for (std::uint32_t side = 0; side < sides_; ++side) sum += cells_[side].area;
  return sum;
}

}  // namespace relumbre
